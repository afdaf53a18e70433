// The page: shows the scene that the server has, and says what a person does about it.

import * as server from "/server.js";
import { captions, write } from "/did.js";
import { Player, SPEEDS } from "/player.js";
import { Films } from "/film.js";
import { Videos } from "/video.js";
import { View, colour, drawSpace, surface } from "/space.js";
import { drawPlots, layOut } from "/plots.js";

/// A question that has just come is not answered by what was meant for the one before it.
const SETTLE_MS = 400;

/// Scenes with clips, and scenes in which there is nothing to do but wait.
const WATCHED = ["asking", "did"];
const WAITING = ["looking", "thinking", "preparing"];

const get = (id) => document.getElementById(id);
const figures = [...document.querySelectorAll("figure")];
const says = [...document.querySelectorAll("[data-say]")];
let words = {};
let scene = null;
let pictures = null;
let settled = 0;
/// The scene before this one that nobody had to wait in.
let opened = null;
const view = new View();
const player = new Player(draw);
const videos = new Videos([...document.querySelectorAll("video")], showFilms);
const films = new Films(videos, showFilms);
/// What somebody would rather see.
let preferred = "film";

function fill(name, values = {}) {
  return Object.entries(values).reduce((text, [key, value]) => text.replaceAll(`{${key}}`, value), words[name] ?? name);
}

/// A button's words and its key.
function label(button, name, key) {
  button.replaceChildren(words[name]);
  if (key) {
    const cap = document.createElement("kbd");
    cap.textContent = words[key];
    button.append(cap);
  }
}

function dress() {
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = words[element.dataset.word];
  for (const button of says) label(button, button.dataset.say, `key-${button.dataset.say}`);
  const turns = ["turn-left", "turn-right", "turn-up", "turn-down"];
  document.querySelectorAll("[data-turn]").forEach((button, i) => {
    button.setAttribute("aria-label", words[turns[i]]);
    button.title = `${words[turns[i]]}. ${words["view-hint"]}`;
  });
  label(get("back"), "key-back");
  label(get("forward"), "key-forward");
  get("back").setAttribute("aria-label", words.back);
  get("forward").setAttribute("aria-label", words.forward);
  label(get("film"), "show-numbers", "key-film");
  label(get("copy"), "copy");
  label(get("done"), "done", "key-done");
  for (const button of document.querySelectorAll("[data-look]")) label(button, "look", "key-look");
  for (const id of ["pair-before", "pair-next", "more"]) label(get(id), id, `key-${id}`);
  get("acts").setAttribute("aria-label", words["did-label"]);
  get("playback").setAttribute("aria-label", words["player-label"]);
  get("answers").setAttribute("aria-label", words["answers-label"]);
  get("view").setAttribute("aria-label", words["view-label"]);
  get("scrub").setAttribute("aria-label", words.scrub);
  get("speed").append(...SPEEDS.map((speed) => new Option(`${speed}×`, speed)));
  get("speed").title = `${words["key-slower"]} ${words["key-faster"]}`;
}

/// Draws a frame of both clips, and where in them that is.
function draw(frame) {
  if (!pictures) return;
  const filmed = inPictures();
  pictures.forEach((picture, i) => {
    const canvas = figures[i].querySelector(!filmed ? ".space" : films.running ? "video" : ".film");
    const now = Math.min(frame, picture.frames - 1);
    const step = now * picture.stride;
    const rate = player.playing ? (player.speed * picture.stride) / picture.period_s : 0;
    if (filmed && films.running) videos.follow(i, step, rate, (picture.frames - 1 - now) * picture.stride);
    else if (filmed) films.draw(canvas, i, step);
    else if (picture.places.length) drawSpace(canvas, picture, frame, view);
    canvas.setAttribute("aria-label", fill("clip-label", {
      side: figures[i].querySelector("strong").textContent,
      episode: picture.episode,
      frame: now + 1,
      frames: picture.frames,
    }));
    if (!filmed) drawPlots(figures[i].querySelector(".plots"), picture, frame);
  });
  get("scrub").value = frame;
  const [now, all] = [frame, player.frames - 1].map((it) => (it * player.period).toFixed(2));
  get("time").textContent = fill("time", { now, all });
  get("scrub").setAttribute("aria-valuetext", get("time").textContent);
  label(get("play"), player.playing ? "pause" : "play", "key-play");
  get("speed").value = player.speed;
  drawSeen();
}

function inPictures() {
  return preferred === "film" && films.ready;
}

/// Shows pictures or numbers, whichever is preferred and there, and says how far the pictures are.
function showFilms() {
  if (!pictures) return;
  const filmed = inPictures();
  figures.forEach((figure, i) => {
    figure.querySelector(".film").hidden = !filmed || films.running;
    figure.querySelector("video").hidden = !filmed || !films.running;
    figure.querySelector(".space").hidden = filmed || !pictures[i].places.length;
    figure.querySelector(".plots").hidden = filmed;
  });
  if (!filmed) videos.pause();
  get("view").hidden = filmed || !pictures[0].places.length;
  get("still").hidden = filmed;
  const focused = document.activeElement === get("film");
  get("film").hidden = !films.ready;
  if (focused && get("film").hidden) get("title").focus({ preventScroll: true });
  label(get("film"), filmed ? "show-numbers" : "show-pictures", "key-film");
  const { trouble, first, all } = films.progress ?? {};
  const [made, of] = (films.ready ? all : first) ?? [0, 0];
  const making = made < of ? fill(films.ready ? "film-finer" : "film-first", { made, of }) : "";
  const why = videos.broken ? fill("no-video", { camera: videos.about.cameras[videos.camera] }) : trouble;
  get("film-note").textContent = why ? fill("no-film", { why }) : making;
  showCameras();
  draw(player.frame);
}

/// Offers the cameras where there is a choice.
function showCameras() {
  const cameras = videos.about?.cameras ?? [];
  get("cameras").hidden = cameras.length < 2 || preferred !== "film";
  const select = get("camera");
  if ([...select.options].map((it) => it.text).join() !== cameras.join()) select.replaceChildren(...cameras.map((it, i) => new Option(it, i)));
  if (cameras.length) select.value = videos.camera;
}

function drawSeen() {
  const { context, width, height } = surface(get("seen-bar"));
  context.fillStyle = colour("--grid");
  context.fillRect(0, 0, width, height);
  context.fillStyle = colour("--seen");
  const each = width / player.frames;
  player.seen.forEach((seen, i) => seen && context.fillRect(i * each, 0, each + 0.5, height));
  get("seen").textContent = fill("seen", { percent: Math.floor(100 * player.share()) });
}

function only(id) {
  for (const section of ["waiting", "asking", "ending"]) get(section).hidden = section !== id;
}

function title(text) {
  get("title").textContent = text;
  document.title = `${text} · ted`;
}

async function show(next) {
  const before = scene;
  scene = next;
  settled = 0;
  get("subtitle").textContent = fill("of-dataset", { dataset: scene.dataset });
  get("said").hidden = !["asking", "did", "review"].includes(scene.phase);
  get("odd").hidden = scene.phase !== "did";
  get("look-back").hidden = scene.phase !== "review";
  showSaid();
  if (!WATCHED.includes(scene.phase)) unload();
  if (WAITING.includes(scene.phase)) {
    if (scene.phase === "looking") title(words["looking-title"]);
    get("waiting-text").textContent = words[scene.phase];
    // What comes next comes in a moment: nothing jumps meanwhile.
    if (scene.phase === "looking" || !WATCHED.includes(before?.phase)) only("waiting");
    for (const button of says) button.disabled = true;
    if (before?.phase === "asking") get("why").textContent = words[scene.phase];
    return;
  }
  get("look").hidden = scene.phase !== "asking";
  if (scene.phase === "asking") await ask();
  else if (scene.phase === "did") await look();
  else end();
  opened = scene.phase;
}

/// Leaves no clip to watch.
function unload() {
  pictures = null;
  films.clear();
  player.load(0, 1);
}

/// Loads both clips of a scene; false when it is over meanwhile, and the next one is on its way.
async function load(at) {
  const both = await server.clips(at);
  if (!both || scene.at !== at) return false;
  pictures = both;
  return true;
}

async function ask() {
  const at = scene.at;
  if (!(await load(at))) return;
  title(`${fill("question", { number: scene.number, of: scene.of })}: ${words.ask}`);
  get("why").textContent = scene.why ? fill("why", { why: scene.why }) : words["no-why"];
  for (const button of says) button.disabled = true;
  lay(false);
  // Whoever pressed a button with the keyboard hears the next question, and goes on from there.
  if (opened === "did" || document.activeElement === document.body || document.activeElement.disabled) get("title").focus({ preventScroll: true });
  play(at, pictures.map((picture, i) => {
    const to = picture.start + (picture.frames - 1) * picture.stride;
    const heading = words[i ? "right-heading" : "left-heading"];
    return { heading, clip: fill("clip", { episode: picture.episode, from: picture.start, to }) };
  }));
  settled = performance.now() + SETTLE_MS;
  setTimeout(() => {
    for (const button of says) button.disabled = button.dataset.say === "undo" && !scene.said.length;
  }, SETTLE_MS);
}

/// Shows what the answers did. Turning to another pair leaves the focus where it is.
async function look() {
  const { at, shown } = scene;
  if (shown && !(await load(at))) return;
  title(words["did-title"]);
  write(scene, { fill, label, again: (place) => say({ say: "reopen", place }) });
  lay(true);
  if (opened !== "did") {
    get("title").focus();
    settled = performance.now() + SETTLE_MS;
  }
  if (shown) play(at, captions(scene, fill));
  else unload();
}

/// Lays the page out for a question, or for what the answers did.
function lay(looking) {
  only("asking");
  get("asking").classList.toggle("looking", looking);
  get("why").hidden = looking;
  get("answers").hidden = looking;
  get("did").hidden = !looking;
  get("acts").hidden = !looking;
  for (const id of ["clips", "playback", "still", "film-note"]) get(id).hidden = looking && !scene.shown;
}

/// Plays both clips of a scene from their beginning, under these captions.
function play(at, captions) {
  view.fit(pictures);
  captions.forEach(({ heading, clip }, i) => {
    figures[i].querySelector("strong").textContent = heading;
    figures[i].querySelector(".clip-name").textContent = clip;
    figures[i].querySelector(".plots").setAttribute("aria-label", `${heading}: ${words.plots}`);
  });
  const still = layOut(figures.map((it) => it.querySelector(".plots")), pictures, words);
  get("still").textContent = still.length ? fill("still", { names: still.join(", ") }) : "";
  const frames = Math.max(...pictures.map((it) => it.frames));
  get("scrub").max = frames - 1;
  player.begin(frames, pictures[0].period_s);
  films.begin(at);
  showFilms();
}

function end() {
  only("ending");
  const { phase, stuck, end: how } = scene;
  const ended = phase === "ended";
  const name = !ended ? (stuck ? "stuck" : "review") : how.how === "stopped" ? "stopped" : "next";
  title(words[`${name}-title`]);
  const text = { review: words.review, stuck, next: words[how?.how] ?? "", stopped: words.stopped }[name];
  get("ending-text").textContent = text;
  const code = how?.how === "next" || how?.how === "stopped" ? how.text : null;
  get("command").hidden = !code;
  get("command-text").textContent = code ?? "";
  // Only a page of this machine, or over TLS, may write to the clipboard.
  get("copy").hidden = how?.how !== "next" || !navigator.clipboard;
  get("done").hidden = ended || Boolean(stuck);
  get("title").focus();
}

function showSaid() {
  const line = (it, i) => {
    const said = words[`said-${it.said}`];
    const item = document.createElement("li");
    item.textContent = fill("said-line", { left: it.episodes[0], right: it.episodes[1], said, by: it.by });
    const change = document.createElement("button");
    change.type = "button";
    change.textContent = words.change;
    change.setAttribute("aria-label", fill("change-label", { line: i + 1, said }));
    change.addEventListener("click", () => say({ say: "reopen", place: i }));
    item.append(change);
    return item;
  };
  get("said-list").replaceChildren(...scene.said.map(line));
  get("change-note").textContent = words[scene.said.length ? "change-note" : "said-none"];
}

/// Says something about the scene that is shown.
async function say(word) {
  if (performance.now() < settled) return;
  settled = Infinity;
  const { at } = scene;
  for (const button of says) button.disabled = true;
  try {
    const taken = await server.say(at, word);
    get("notice").textContent = taken ? "" : words["too-late"];
  } catch {
    get("notice").textContent = words.lost;
  }
  // What came of it may be there already.
  if (scene.at === at) settled = 0;
}

/// Opens what the answers did, or leaves it.
function toggleLook() {
  if (scene?.phase === "did") say({ say: "back" });
  else if ((scene?.phase === "asking" && pictures) || scene?.phase === "review") say({ say: "look" });
}

/// Turns to the next pair or the one before; after the last comes the first.
function turnPair(by) {
  const { phase, pair, pairs } = scene ?? {};
  if (phase === "did" && pairs > 1) say({ say: "turn", pair: (pair + by + pairs) % pairs });
}

function more() {
  if (scene?.phase === "did" && scene.open !== "stuck") say({ say: "more" });
}

function press(name) {
  if (name === "film") {
    if (films.ready) preferred = preferred === "film" ? "numbers" : "film";
    showFilms();
  } else if (scene?.phase === "asking" && pictures) {
    if (name !== "undo") say({ say: name });
    else if (scene.said.length) say({ say: "reopen", place: scene.said.length - 1 });
  } else if (scene?.phase === "review" && name === "undo" && scene.said.length) {
    say({ say: "reopen", place: scene.said.length - 1 });
  }
}

const KEYS = {
  1: () => press("left"), 2: () => press("right"), 3: () => press("equal"), 4: () => press("cannot-tell"),
  5: () => press("later"), u: () => press("undo"), p: () => press("film"), " ": () => player.toggle(), ArrowLeft: () => player.step(-1),
  w: toggleLook, n: () => turnPair(1), b: () => turnPair(-1), m: more,
  ArrowRight: () => player.step(1), "+": () => speed(1), "=": () => speed(1), "-": () => speed(-1),
};

function speed(by) {
  player.faster(by);
  draw(player.frame);
}

function listen() {
  for (const button of says) button.addEventListener("click", () => press(button.dataset.say));
  for (const id of ["done", "enough"]) get(id).addEventListener("click", () => say({ say: "done" }));
  for (const button of document.querySelectorAll("[data-look], #leave")) button.addEventListener("click", toggleLook);
  get("pair-before").addEventListener("click", () => turnPair(-1));
  get("pair-next").addEventListener("click", () => turnPair(1));
  get("more").addEventListener("click", more);
  get("play").addEventListener("click", () => player.toggle());
  get("film").addEventListener("click", () => press("film"));
  get("back").addEventListener("click", () => player.step(-1));
  get("forward").addEventListener("click", () => player.step(1));
  get("scrub").addEventListener("input", (event) => player.seek(Number(event.target.value)));
  get("speed").addEventListener("change", (event) => {
    player.speed = Number(event.target.value);
  });
  get("camera").addEventListener("change", (event) => videos.prefer(Number(event.target.value)));
  get("copy").addEventListener("click", async () => {
    await navigator.clipboard.writeText(get("command-text").textContent);
    get("copy").textContent = words.copied;
  });
  for (const button of document.querySelectorAll("[data-turn]")) {
    const [yaw, pitch] = button.dataset.turn.split(",").map(Number);
    button.addEventListener("click", () => turn(yaw * 0.3, pitch * 0.25));
  }
  for (const canvas of document.querySelectorAll(".space")) {
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) turn(event.movementX * 0.01, event.movementY * 0.01);
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // A key that is held steps on, but answers once.
    if (event.repeat && event.key.length === 1) return;
    const { target } = event;
    const scrubs = target.matches("input[type=range], select");
    if (scrubs && event.key.startsWith("Arrow")) return;
    const presses = target.matches("button, select, input[type=checkbox]");
    if (presses && [" ", "Enter"].includes(event.key)) return;
    const atTheEnd = scene?.phase === "review" ? !scene.stuck : scene?.phase === "did" && scene.open === "review";
    if (event.key === "Enter" && atTheEnd) {
      say({ say: "done" });
      return;
    }
    const digit = /^(?:Digit|Numpad)([1-5])$/.exec(event.code)?.[1];
    const act = KEYS[digit ?? event.key] ?? KEYS[event.key.toLowerCase()];
    if (!act || (event.key.length === 1 && !get("keys").checked)) return;
    event.preventDefault();
    act();
  });
  const again = () => draw(player.frame);
  addEventListener("resize", again);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
}

function turn(yaw, pitch) {
  view.turn(yaw, pitch);
  draw(player.frame);
}

async function follow() {
  let at = null;
  let failures = 0;
  for (;;) {
    try {
      const next = await server.sceneAfter(at);
      failures = 0;
      if (get("notice").textContent === words.lost) get("notice").textContent = "";
      if (next.at !== at) {
        at = next.at;
        await show(next);
      }
      if (next.phase === "ended") return;
    } catch {
      failures += 1;
      // Once is a lost packet, twice is a lost server.
      if (failures > 1) get("notice").textContent = words.lost;
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
  }
}

// The token has done its work: it need not be seen over a shoulder.
history.replaceState(null, "", "/");
words = await server.words();
dress();
listen();
await follow();
