// Pictures of both clips: videos where the logs have some, otherwise stills as they are made, coarse first and then finer. The numbers never
// wait for them.

import * as server from "/server.js";
import { surface } from "/space.js";

/// How often one looks whether there are more.
const LOOK_MS = 250;

export class Films {
  /// Calls `changed()` whenever there is more to show, or more to say. Videos are shown by these.
  constructor(videos, changed) {
    this.videos = videos;
    this.changed = changed;
    this.clear();
  }

  /// Forgets the films of the question before.
  clear() {
    this.at = null;
    this.progress = null;
    this.stills = [new Map(), new Map()];
    this.videos.clear();
  }

  /// Begins with those of a scene, and follows them to their end.
  async begin(at) {
    this.clear();
    this.at = at;
    while (this.at === at) {
      // A request that is lost is made again; a scene that is over has no films.
      const progress = await server.film(at).catch(() => undefined);
      if (this.at !== at || progress === null) return;
      if (progress) {
        await this.fetch(at, progress);
        if (this.at !== at) return;
        this.progress = progress;
        if (progress.videos) this.videos.begin(at, progress.videos);
        this.changed();
        const here = this.stills[0].size + this.stills[1].size;
        if (progress.trouble || here === progress.all[1]) return;
      }
      await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
    }
  }

  /// Loads what is made and not yet here. What does not arrive is asked for again the next time.
  async fetch(at, progress) {
    const load = async (side, still) => {
      const image = new Image();
      image.src = server.still(at, side, still);
      const whole = await image.decode().then(() => true, () => false);
      if (whole && this.at === at) this.stills[side].set(still, image);
    };
    const missing = progress.films.flatMap((film, side) => {
      return film.made.filter((still) => !this.stills[side].has(still)).map((still) => load(side, still));
    });
    await Promise.all(missing);
  }

  /// Whether there is a film to look at: without the first stills of both clips, one would be judged by less than the other.
  get ready() {
    const { progress } = this;
    if (progress?.videos) return this.videos.ready;
    return Boolean(progress?.films.length) && progress.first[0] === progress.first[1] && this.stills.every((it) => it.size > 0);
  }

  /// Whether these are videos.
  get running() {
    return Boolean(this.progress?.videos);
  }

  /// Draws the last still that is there at a step after the clip's first one.
  draw(canvas, side, step) {
    const { context, width, height } = surface(canvas);
    let at = Math.floor(step / this.progress.films[side].every);
    while (at > 0 && !this.stills[side].has(at)) at -= 1;
    const image = this.stills[side].get(at);
    if (!image) return;
    const scale = Math.min(width / image.width, height / image.height);
    const [w, h] = [image.width * scale, image.height * scale];
    context.drawImage(image, (width - w) / 2, (height - h) / 2, w, h);
  }
}
