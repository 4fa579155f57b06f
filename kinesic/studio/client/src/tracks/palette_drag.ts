// Chips of the palette and rows of the gesture list, which are dragged onto a word or a time.
import { byId, make } from "../dom.ts";
import { PALETTE } from "../palette.ts";
import { recall, remember } from "../remembered.ts";
import type { Timeline } from "../timeline.ts";
import type { Snap } from "./snapping.ts";

const MIN_DISTANCE = 4; // [CSS pixels] shorter drags are clicks
const OPEN_KEY = "palette-open";

/** Fill the palette, and call `drop` with KIND:VALUE and its place on the timeline, or `press` without a place. */
export function listenToDrops(
  timeline: Timeline,
  listener: { drop(value: string, snap: Snap): void; press(value: string): void },
): void {
  fillPalette();
  document.addEventListener("pointerdown", (event) => {
    const element = event.target as Element;
    const source = element.closest<HTMLElement>("[data-add]");
    const inner = element.closest("button");
    if (source && event.button === 0 && (inner === null || inner === source))
      beginDrop(event, source, timeline, listener);
  });
  byId("palette").addEventListener("click", (event) => {
    const { add } = (event.target as HTMLElement).dataset;
    if (add) listener.press(add);
  });
}

function fillPalette(): void {
  const place = byId("palette");
  for (const [group, entries] of Object.entries(PALETTE)) {
    const chips = entries.map(({ label }) =>
      make(
        "button",
        {
          type: "button",
          class: "chip",
          "data-add": `palette:${group}/${label}`,
          title: "Drag it onto a word or a time; a click adds it at the time of the slider",
        },
        label,
      ),
    );
    place.append(make("span", { role: "group", "aria-label": group }, make("b", {}, group), ...chips));
  }
  const toggle = byId("show-palette");
  const open = (on: boolean) => {
    place.hidden = !on;
    toggle.setAttribute("aria-expanded", String(on));
    remember(OPEN_KEY, Number(on));
  };
  open(recall(OPEN_KEY, 0, 0, 1) === 1);
  toggle.addEventListener("click", () => open(place.hasAttribute("hidden")));
}

function beginDrop(
  down: PointerEvent,
  source: HTMLElement,
  timeline: Timeline,
  listener: { drop(value: string, snap: Snap): void },
): void {
  const ended = new AbortController();
  const options = { signal: ended.signal };
  const ghost = make(
    "div",
    { class: "ghost", "aria-hidden": "true" },
    source.dataset.label ?? source.textContent ?? "",
  );
  let snap: Snap | null = null;
  const move = (event: PointerEvent) => {
    const { clientX: x, clientY: y } = event;
    if (!ghost.isConnected && Math.hypot(x - down.clientX, y - down.clientY) < MIN_DISTANCE) return;
    document.body.append(ghost);
    ghost.style.translate = `${x + 8}px ${y + 8}px`;
    snap = timeline.dropAt(x, y);
    timeline.showSnap(snap ?? undefined);
  };
  const end = (isDropped: boolean) => {
    ended.abort();
    if (ghost.isConnected) preventClick();
    ghost.remove();
    timeline.showSnap(undefined);
    if (isDropped && snap) listener.drop(source.dataset.add!, snap);
  };
  down.preventDefault();
  document.addEventListener("pointermove", move, options);
  document.addEventListener("pointerup", () => end(true), options);
  document.addEventListener("pointercancel", () => end(false), options);
  document.addEventListener("keydown", (event) => event.key === "Escape" && end(false), options);
}

/** Ignore the click with which a drag ends. */
function preventClick(): void {
  const ignored = new AbortController();
  document.addEventListener("click", (event) => event.stopPropagation(), { capture: true, signal: ignored.signal });
  setTimeout(() => ignored.abort());
}
