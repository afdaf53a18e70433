// What is asked of the server: the scene, its clips, and one way to say something.

/// The words of the page.
export async function words() {
  return (await fetch("/words.json")).json();
}

/// The scene after the one of this number; waits for it. Throws when the server is gone.
export async function sceneAfter(at) {
  const query = at === null ? "" : `?after=${at}`;
  const response = await fetch(`/api/scene${query}`);
  if (!response.ok) throw new Error(await response.text());
  return response.json();
}

/// Both clips of a scene; null when it is over.
export async function clips(at) {
  const both = await Promise.all(["left", "right"].map((side) => fetch(`/api/clip/${at}/${side}`)));
  if (both.some((response) => !response.ok)) return null;
  return Promise.all(both.map((response) => response.json()));
}

/// How far the films of a scene are; null when it is over.
export async function film(at) {
  const response = await fetch(`/api/film/${at}`);
  if (!response.ok) throw new Error(await response.text());
  return response.status === 204 ? null : response.json();
}

/// Where a still of one of them is.
export function still(at, side, still) {
  return `/api/film/${at}/${["left", "right"][side]}/${still}`;
}

/// Where the video of one of its clips is.
export function video(at, side, camera) {
  return `/api/video/${at}/${["left", "right"][side]}/${camera}`;
}

/// Says something about a scene. False when that came too late.
export async function say(at, word) {
  const response = await fetch("/api/say", {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ at, ...word }),
  });
  if (response.status === 409) return false;
  if (!response.ok) throw new Error(await response.text());
  return true;
}
