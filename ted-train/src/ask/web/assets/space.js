// Places in space as moving points with trails: a plain view with parallel lines that can be turned.

const TRAIL = 80;
/// Room around the places, and above them for their names.
const MARGIN = 22;
const LEGEND = 22;
const COLOURS = { circle: "--hand", square: "--object", triangle: "--second", cross: "--goal" };

/// A canvas that is as sharp as the screen; gives its context and its size in CSS pixels.
export function surface(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/// Reads a colour of the style sheet, which knows light and dark.
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/// From where both pictures are looked at.
export class View {
  constructor() {
    this.yaw = -0.6;
    this.pitch = 0.5;
    this.flat = false;
  }

  /// Makes room for these pictures.
  fit(pictures) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const place of pictures.flatMap((it) => it.places)) {
      for (const at of place.path) {
        for (let i = 0; i < 3; i += 1) {
          low[i] = Math.min(low[i], at[i]);
          high[i] = Math.max(high[i], at[i]);
        }
      }
    }
    const flat = low[2] === high[2];
    // What lies on a table is looked at from above.
    if (flat !== this.flat) [this.yaw, this.pitch] = flat ? [0, Math.PI / 2] : [-0.6, 0.5];
    this.flat = flat;
    this.low = low;
    this.high = high;
    this.centre = low.map((x, i) => (x + high[i]) / 2);
    const size = Math.hypot(...low.map((x, i) => high[i] - x));
    this.size = size > 0 ? size : 1;
    const floor = [0, 1, 2, 3].map((i) => [(i & 1 ? high : low)[0], (i & 2 ? high : low)[1], low[2]]);
    this.points = [...pictures.flatMap((it) => it.places.flatMap((place) => place.path)), ...floor];
    this.turned = null;
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.max(0, Math.min(Math.PI / 2, this.pitch + pitch));
  }

  /// How far right and how far up a place is seen, in units of the world.
  seen(at) {
    const [x, y, z] = at.map((value, i) => value - this.centre[i]);
    const [cos, sin] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    const away = x * sin + y * cos;
    return [x * cos - y * sin, z * Math.cos(this.pitch) + away * Math.sin(this.pitch)];
  }

  /// From places in the world to places on a screen of this size, which they fill.
  onto(width, height) {
    const { low, high } = this.reach();
    const room = [width - 2 * MARGIN, height - LEGEND - 2 * MARGIN];
    const scale = Math.min(...room.map((it, i) => it / Math.max(high[i] - low[i], this.size * 0.1)));
    const [middle, level] = low.map((it, i) => (it + high[i]) / 2);
    return (at) => {
      const [right, up] = this.seen(at);
      return [width / 2 + (right - middle) * scale, LEGEND + (height - LEGEND) / 2 - (up - level) * scale];
    };
  }

  /// From where to where everything is seen, found once for each turn.
  reach() {
    const turned = `${this.yaw} ${this.pitch}`;
    if (this.turned === turned) return this.reached;
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (const at of this.points) {
      this.seen(at).forEach((value, i) => {
        low[i] = Math.min(low[i], value);
        high[i] = Math.max(high[i], value);
      });
    }
    this.turned = turned;
    this.reached = { low, high };
    return this.reached;
  }
}

/// Draws one picture at a frame.
export function drawSpace(canvas, picture, frame, view) {
  const { context, width, height } = surface(canvas);
  const to = view.onto(width, height);
  floor(context, view, to);
  const now = Math.min(frame, picture.frames - 1);
  for (const place of picture.places) {
    const ink = colour(COLOURS[place.mark]);
    trail(context, place.path, now, to, ink);
    const at = place.path[now];
    if (!view.flat) drop(context, to(at), to([at[0], at[1], view.low[2]]), ink);
    mark(context, place.mark, to(at), ink);
  }
  legend(context, picture.places, width);
}

/// A grid under everything, so that a place has a depth.
function floor(context, view, to) {
  const z = view.low[2];
  const [[x0, y0], [x1, y1]] = [view.low, view.high];
  const margin = view.size * 0.03;
  const [left, right, near, far] = [x0 - margin, x1 + margin, y0 - margin, y1 + margin];
  context.strokeStyle = colour("--grid");
  context.lineWidth = 1;
  context.beginPath();
  for (let i = 0; i <= 6; i += 1) {
    const x = left + ((right - left) * i) / 6;
    const y = near + ((far - near) * i) / 6;
    line(context, to([x, near, z]), to([x, far, z]));
    line(context, to([left, y, z]), to([right, y, z]));
  }
  context.stroke();
}

function line(context, from, end) {
  context.moveTo(...from);
  context.lineTo(...end);
}

function trail(context, path, now, to, ink) {
  context.strokeStyle = ink;
  context.lineCap = "round";
  context.globalAlpha = 0.18;
  context.lineWidth = 1.5;
  context.beginPath();
  path.forEach((at, i) => (i ? context.lineTo(...to(at)) : context.moveTo(...to(at))));
  context.stroke();
  context.lineWidth = 3;
  for (let i = Math.max(1, now - TRAIL); i <= now; i += 1) {
    context.globalAlpha = 0.15 + 0.75 * (1 - (now - i) / TRAIL);
    context.beginPath();
    line(context, to(path[i - 1]), to(path[i]));
    context.stroke();
  }
  context.globalAlpha = 1;
}

function drop(context, at, foot, ink) {
  context.save();
  context.globalAlpha = 0.6;
  context.strokeStyle = ink;
  context.lineWidth = 1;
  context.setLineDash([3, 3]);
  context.beginPath();
  line(context, at, foot);
  context.stroke();
  context.restore();
}

function mark(context, kind, [x, y], ink) {
  context.fillStyle = ink;
  context.strokeStyle = colour("--raised");
  context.lineWidth = 1.5;
  context.beginPath();
  const r = 7;
  if (kind === "circle") context.arc(x, y, r, 0, 2 * Math.PI);
  if (kind === "square") context.rect(x - r, y - r, 2 * r, 2 * r);
  if (kind === "triangle") {
    context.moveTo(x, y - r - 1);
    context.lineTo(x + r + 1, y + r);
    context.lineTo(x - r - 1, y + r);
    context.closePath();
  }
  if (kind === "cross") {
    context.strokeStyle = ink;
    context.lineWidth = 3.5;
    line(context, [x - r, y - r], [x + r, y + r]);
    line(context, [x - r, y + r], [x + r, y - r]);
    context.stroke();
    return;
  }
  context.fill();
  context.stroke();
}

function legend(context, places, width) {
  context.font = "13px system-ui, sans-serif";
  context.textBaseline = "middle";
  let [x, y] = [12, 12];
  for (const place of [...places].reverse()) {
    const long = context.measureText(place.name).width + 13;
    if (x > 12 && x + long > width) [x, y] = [12, y + 20];
    mark(context, place.mark, [x, y], colour(COLOURS[place.mark]));
    context.fillStyle = colour("--ink");
    context.fillText(place.name, x + 13, y);
    x += long + 24;
  }
}
