// Panels around the stage: menus, clock and notices of the plan.
import { byId, make } from "./dom.ts";
import type { About, Draft } from "./types.ts";

/** Fill the menus of templates, examples, styles and gestures. */
export function fillMenus(about: About): void {
  for (const { name } of about.templates) byId("new").append(make("option", { value: `template:${name}` }, name));
  for (const { name } of about.examples)
    byId("built-in").append(make("option", { value: `example:${name}` }, name.replaceAll("_", " ")));
  for (const place of ["style", "own-style"])
    for (const name of about.styles) byId(place).append(make("option", { value: name }, name));
  for (const { id, says } of about.gestures) byId("gestures").append(make("option", { value: id }, says));
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

/** List the deviations of the plan from the document. */
export function showNotices(notices: Draft["notices"]): void {
  const lines = notices.map(({ id, text }) => make("li", {}, make("b", {}, id), ` ${text}`));
  byId("notices").replaceChildren(...(lines.length ? lines : [make("li", { class: "none" }, "none")]));
}
