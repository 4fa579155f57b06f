// Panels around the stage: menus, clock and notices of the plan.
import { byId, make } from "./dom.ts";
import { gestureWords, labelWords, typeWords, withGestureWords } from "./plain_words.ts";
import type { About, Draft, Fault } from "./types.ts";

/** Fill the menus of templates, examples, styles and gestures. */
export function fillMenus(about: About): void {
  for (const { name } of about.templates) byId("new").append(make("option", { value: `template:${name}` }, name));
  for (const { name } of about.examples)
    byId("built-in").append(make("option", { value: `example:${name}` }, name.replaceAll("_", " ")));
  for (const place of ["style", "own-style"])
    for (const name of about.styles) byId(place).append(make("option", { value: name }, name));
  for (const { id, says } of about.gestures) byId("gestures").append(make("option", { value: gestureWords(id) }, says));
}

/** Show the player's time and the duration [s]. */
export function showClock(time: number, duration: number, playing: boolean): void {
  const [slider, play] = [byId<HTMLInputElement>("time"), byId("play")];
  if (slider.max !== String(duration)) slider.max = String(duration);
  slider.value = String(time);
  byId("clock").textContent = `${time.toFixed(2)} / ${duration.toFixed(2)} s`;
  if (play.classList.toggle("playing", playing) === (play.getAttribute("aria-label") === "Pause")) return;
  play.setAttribute("aria-label", playing ? "Pause" : "Play");
}

/** List the deviations of the plan from the document; gestures are named in words. */
export function showNotices({ notices, behaviours }: Draft, gestures: About["gestures"]): void {
  const known = new Set(gestures.map(({ id }) => id));
  const nameOf = (id: string) => {
    const found = behaviours.find((behaviour) => behaviour.id === id.slice(id.lastIndexOf(":") + 1));
    if (!found) return id;
    return found.type === "speech" ? found.type : `${typeWords(found.type)} ${labelWords(found.type, found.label)}`;
  };
  const lines = notices.map(({ id, text }) =>
    make("li", { title: id }, make("b", {}, nameOf(id)), ` ${withGestureWords(text, (word) => known.has(word))}`),
  );
  byId("notices").replaceChildren(...(lines.length ? lines : [make("li", { class: "none" }, "none")]));
}

/** Show an error of the document in place of the notices. */
export const showFault = ({ line, column, text }: Fault): void =>
  byId("notices").replaceChildren(make("li", {}, make("b", {}, `line ${line}, column ${column}`), ` ${text}`));
