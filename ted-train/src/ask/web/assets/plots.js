// Numbers that are no places: what was observed as curves that scroll past, what was done as bars.

import { colour, surface } from "/space.js";

/// Frames that a curve shows at a time.
const WINDOW = 200;

/// Whether a number moves in either clip, and from where to where.
function range(name, pictures, kind) {
  const values = pictures.flatMap((it) => it[kind].find((track) => track.name === name).values);
  const [low, high] = values.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
  return { low, high, moves: low !== high };
}

/// Lays out the rows of both clips, with one scale for a number in both, and gives the names of those that do not move.
export function layOut(boxes, pictures, words) {
  const ranges = new Map(pictures[0].plots.map((it) => [it.name, range(it.name, pictures, "plots")]));
  boxes.forEach((box, side) => {
    box.replaceChildren();
    const moving = pictures[side].plots.filter((it) => ranges.get(it.name).moves);
    if (moving.length) box.append(heading(words.plots));
    box.append(...moving.map((it) => row(it, "plot")));
    box.append(heading(words.actions));
    box.append(...pictures[side].actions.map((it) => row(it, "action")));
    box.ranges = ranges;
  });
  return pictures[0].plots.filter((it) => !ranges.get(it.name).moves).map((it) => it.name);
}

function heading(text) {
  const heading = document.createElement("h2");
  heading.textContent = text;
  return heading;
}

function row(track, kind) {
  const row = document.createElement("div");
  row.className = `track ${kind}`;
  row.track = track;
  const name = document.createElement("span");
  name.className = "name";
  name.textContent = track.unit && track.unit !== "1" ? `${track.name} (${track.unit})` : track.name;
  name.title = name.textContent;
  const canvas = document.createElement("canvas");
  canvas.setAttribute("aria-hidden", "true");
  const value = document.createElement("span");
  value.className = "value";
  row.append(name, canvas, value);
  return row;
}

/// Draws the rows of one clip at a frame.
export function drawPlots(box, picture, frame) {
  const now = Math.min(frame, picture.frames - 1);
  for (const row of box.querySelectorAll(".track")) {
    const { name, values } = row.track;
    const canvas = row.querySelector("canvas");
    if (row.classList.contains("plot")) curve(canvas, values, now, box.ranges.get(name));
    else bar(canvas, values[now]);
    row.querySelector(".value").textContent = short(values[now]);
  }
}

function curve(canvas, values, now, { low, high }) {
  const { context, width, height } = surface(canvas);
  const count = Math.min(WINDOW, values.length);
  const first = Math.max(0, Math.min(values.length - count, now - Math.floor(count / 2)));
  const x = (i) => ((i - first) / Math.max(1, count - 1)) * (width - 4) + 2;
  const y = (value) => height - 2 - ((value - low) / (high - low)) * (height - 4);
  context.lineWidth = 1.5;
  for (const [from, to, alpha] of [[first, first + count - 1, 0.35], [first, now, 1]]) {
    context.globalAlpha = alpha;
    context.strokeStyle = colour("--hand");
    context.beginPath();
    for (let i = from; i <= to; i += 1) context.lineTo(x(i), y(values[i]));
    context.stroke();
  }
  context.globalAlpha = 1;
  context.fillStyle = colour("--object");
  context.beginPath();
  context.arc(x(now), y(values[now]), 3, 0, 2 * Math.PI);
  context.fill();
}

function bar(canvas, value) {
  const { context, width, height } = surface(canvas);
  context.fillStyle = colour("--grid");
  context.fillRect(0, height / 2 - 0.5, width, 1);
  context.fillStyle = colour(value < 0 ? "--bar-down" : "--bar-up");
  const long = (Math.max(-1, Math.min(1, value)) * width) / 2;
  context.fillRect(Math.min(width / 2, width / 2 + long), 1, Math.abs(long), height - 2);
  context.fillStyle = colour("--line");
  context.fillRect(width / 2 - 0.5, 0, 1, height);
}

/// A number in few characters.
export function short(value) {
  const size = Math.abs(value);
  if (size === 0) return "0";
  return size >= 1e-3 && size < 1e5 ? value.toPrecision(3) : value.toExponential(1);
}
