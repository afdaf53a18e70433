// What the answers did, in words: how sure it is, what is shown, and which answers do not go with the rest.

const get = (id) => document.getElementById(id);

/// Writes a scene's words. `fill` knows all of them, `label` dresses a button, and `again` asks the question of a place in the log.
export function write(scene, { fill, label, again }) {
  const paragraph = (text) => {
    const it = document.createElement("p");
    it.textContent = text;
    return it;
  };
  const says = scene.says.map(paragraph);
  if (scene.odd.length) says.push(way(fill("odd-below", { count: scene.odd.length })));
  get("did-says").replaceChildren(...says);
  get("did-pair").textContent = scene.shown ? fill("did-pair", { pair: scene.pair + 1, pairs: scene.pairs }) : "";
  get("odd-heading").textContent = fill(scene.odd.length ? "odd-heading" : "odd-none");
  get("odd-list").replaceChildren(...scene.odd.map((odd) => line(odd, fill, again)));
  for (const id of ["pair-before", "pair-next"]) get(id).hidden = scene.pairs < 2;
  const [extra, review, stuck] = ["extra", "review", "stuck"].map((open) => scene.open === open);
  get("more").hidden = stuck;
  get("enough").hidden = !extra && !review;
  label(get("enough"), "done", review && "key-done");
  label(get("leave"), review || stuck ? "to-answers" : "to-question", "key-look");
}

/// What each side shows; none where nobody can say.
export function captions(scene, fill) {
  return scene.shown?.map(({ episode, above }, side) => {
    const signed = `${above < 0 ? "−" : "+"}${Math.abs(above).toFixed(1)}`;
    return {
      heading: fill(["did-best", "did-worst"][side], { place: scene.pair + 1 }),
      clip: fill("did-clip", { episode, above: signed }),
    };
  });
}

/// A way to what stands under the clips.
function way(text) {
  const paragraph = document.createElement("p");
  const link = document.createElement("a");
  link.href = "#odd";
  link.textContent = text;
  paragraph.append(link);
  return paragraph;
}

function line({ place, says }, fill, again) {
  const item = document.createElement("li");
  item.textContent = `${place + 1}. ${says} `;
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = fill("odd-change");
  button.setAttribute("aria-label", fill("odd-label", { line: place + 1 }));
  button.addEventListener("click", () => again(place));
  item.append(button);
  return item;
}
