// One clock for both clips: a frame, a speed, and which frames were seen.

const HOLD_S = 0.7;
export const SPEEDS = [0.25, 0.5, 1, 2, 4];

export class Player {
  /// Calls `draw(frame)` whenever another frame is to be seen.
  constructor(draw) {
    this.draw = draw;
    this.speed = 1;
    this.load(0, 1);
    this.tick = this.tick.bind(this);
    requestAnimationFrame(this.tick);
  }

  /// Begins with a clip of so many frames.
  load(frames, period) {
    this.frames = frames;
    this.period = period;
    this.seen = new Uint8Array(frames);
    this.playing = false;
    this.held = 0;
    this.show(0);
  }

  /// Another clip that plays from its beginning, unless people want things to stand still.
  begin(frames, period) {
    this.load(frames, period);
    this.playing = frames > 1 && !matchMedia("(prefers-reduced-motion: reduce)").matches;
  }

  toggle() {
    this.playing = !this.playing && this.frames > 1;
    this.held = 0;
    this.draw(this.frame);
  }

  /// Goes to a frame and stays there.
  seek(frame) {
    this.playing = false;
    this.show(frame);
  }

  step(by) {
    this.seek((this.frame + by + this.frames) % Math.max(this.frames, 1));
  }

  faster(by) {
    const at = SPEEDS.indexOf(this.speed) + by;
    this.speed = SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, at))];
  }

  share() {
    return this.frames ? this.seen.reduce((sum, it) => sum + it, 0) / this.frames : 0;
  }

  show(frame) {
    const to = Math.max(0, Math.min(this.frames - 1, frame));
    this.time = to * this.period;
    this.frame = to;
    if (this.frames) this.seen[to] = 1;
    this.draw(to);
  }

  tick(now) {
    const passed = Math.min(0.25, (now - (this.last ?? now)) / 1000);
    this.last = now;
    if (this.playing) this.advance(passed);
    requestAnimationFrame(this.tick);
  }

  advance(passed) {
    const end = (this.frames - 1) * this.period;
    if (this.frame === this.frames - 1) {
      this.held += passed;
      if (this.held < HOLD_S) return;
      this.held = 0;
      this.show(0);
      return;
    }
    const time = Math.min(end, this.time + passed * this.speed);
    const frame = Math.min(this.frames - 1, Math.floor(time / this.period + 1e-6));
    // What flew past was seen as well as one sees it at that speed.
    for (let i = this.frame; i <= frame; i += 1) this.seen[i] = 1;
    this.time = time;
    if (frame !== this.frame) {
      this.frame = frame;
      this.draw(frame);
    }
  }
}
