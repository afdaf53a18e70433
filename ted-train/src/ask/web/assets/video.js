// Videos that belong to the logs: both clips run by the page's clock, each cut to its part of its file.

import * as server from "/server.js";

/// Seconds that a running video may be away from the clock before it is put right; below that it runs a little faster or slower.
const APART_S = 0.15;
/// The last seconds of a clip are shown picture by picture: a video that runs would run on into what follows it in its file.
const LAST_S = 0.4;

export class Videos {
  /// Calls `changed()` when both can be seen, or one never will be.
  constructor(elements, changed) {
    this.elements = elements;
    this.changed = changed;
    elements.forEach((element, side) => {
      element.addEventListener("loadedmetadata", () => this.seek(side, 0));
      element.addEventListener("seeked", () => this.loaded(side));
      element.addEventListener("error", () => this.failed());
    });
    this.clear();
  }

  /// Forgets the videos of the question before.
  clear() {
    this.about = null;
    this.broken = false;
    this.there = [false, false];
    for (const element of this.elements) {
      element.removeAttribute("src");
      element.load();
    }
  }

  /// Begins with those of a scene, by the camera that was chosen before if it is there.
  begin(at, about) {
    this.clear();
    this.at = at;
    this.about = about;
    this.choose(Math.max(0, about.cameras.indexOf(this.name)));
  }

  /// Shows both clips by another camera.
  choose(camera) {
    this.camera = camera;
    this.broken = false;
    this.there = [false, false];
    this.elements.forEach((element, side) => {
      element.src = server.video(this.at, side, camera);
    });
  }

  /// Does so because somebody wants it, and for the questions that follow.
  prefer(camera) {
    this.name = this.about.cameras[camera];
    this.choose(camera);
    this.changed();
  }

  loaded(side) {
    if (!this.about || this.there[side]) return;
    this.there[side] = true;
    if (this.ready) this.changed();
  }

  failed() {
    if (!this.about || this.broken) return;
    this.broken = true;
    this.changed();
  }

  /// Whether both can be seen: one alone would be judged by more than the other.
  get ready() {
    return Boolean(this.about) && !this.broken && this.there.every(Boolean);
  }

  /// The middle of the picture that belongs to a step after the clip's first one.
  time(side, step) {
    const { from_s, step_s, frame_s } = this.about.takes[side][this.camera];
    return from_s + step * step_s + frame_s / 2;
  }

  seek(side, step) {
    if (this.about) this.elements[side].currentTime = this.time(side, step);
  }

  /// Puts a video where its clip is: running at so many steps a second with so many steps before it, or still where that is none.
  follow(side, step, rate, left) {
    const element = this.elements[side];
    const { step_s, frame_s } = this.about.takes[side][this.camera];
    const ahead = element.currentTime - this.time(side, step);
    if (rate && left > LAST_S * rate) {
      element.playbackRate = Math.max(0.0625, Math.min(16, rate * step_s * (1 - 2 * ahead)));
      // A video that may not start by itself is moved on by the clock.
      if (element.paused) element.play().catch(() => {});
      if (Math.abs(ahead) > Math.max(APART_S, 2 * step_s) && !element.seeking) this.seek(side, step);
    } else {
      element.pause();
      if (Math.abs(ahead) > frame_s / 4) this.seek(side, step);
    }
  }

  /// Stands still where nobody looks.
  pause() {
    for (const element of this.elements) element.pause();
  }
}
