// Drags on the timeline: blocks, strokes, edges of phases, and a rectangle that selects.
import { make } from "../dom.ts";
import type { Sync } from "../types.ts";
import { edgesOf, mainPoint, type Points } from "./phases.ts";
import { nearest, type Snap, type Target } from "./snapping.ts";

export type Handle = "block" | "stroke" | "edge";

/** Finished drag of a behaviour's point. */
export interface Move {
  behaviour: string;
  handle: Handle;
  sync: Sync;
  /** Shift of the point [s]. */
  by: number;
  target: Target;
}

/** What a drag needs to know of the timeline. */
export interface Ground {
  readonly place: HTMLElement;
  points(behaviour: string): Points | undefined;
  selected(): ReadonlySet<string>;
  timeAt(x: number): number;
  /** [s] duration of a CSS pixel. */
  readonly pixel: number;
  snaps(dragged: ReadonlySet<string>): readonly Snap[];
  /** Snap of the word under the pointer, in the row of words. */
  wordUnder(x: number, y: number): Snap | undefined;
  showSnap(snap: Snap | undefined): void;
}

export interface DragListener {
  moved(move: Move): void;
  seek(time: number): void;
  choose(behaviour: string, isExtended: boolean): void;
  chooseAll(behaviours: readonly string[], isExtended: boolean): void;
}

const CLICK_DISTANCE = 3; // [CSS pixels] shorter drags are clicks
const SNAP_DISTANCE = 9; // [CSS pixels]
const MIN_PHASE = 0.02; // [s] shortest phase that a dragged edge leaves

/** Start the drag or selection that a pressed pointer asks for. */
export function beginDrag(down: PointerEvent, ground: Ground, listener: DragListener): void {
  if (down.button !== 0) return;
  const element = (down.target as Element).closest<HTMLElement>("[data-behaviour]");
  if (element) dragHandle(down, element, ground, listener);
  else if ((down.target as Element).closest(".lane")) dragBand(down, ground, listener);
}

/** Follow the pointer until it is released; `drop` gets null if the drag is cancelled. */
function follow(
  down: PointerEvent,
  element: HTMLElement,
  move: (event: PointerEvent) => void,
  drop: (event: PointerEvent | null) => void,
): void {
  element.setPointerCapture(down.pointerId);
  const ended = new AbortController();
  const options = { signal: ended.signal };
  const end = (event: PointerEvent | null) => {
    ended.abort();
    drop(event);
  };
  element.addEventListener("pointermove", move, options);
  element.addEventListener("pointerup", end, options);
  element.addEventListener("pointercancel", () => end(null), options);
  document.addEventListener("keydown", (event) => event.key === "Escape" && end(null), options);
}

function dragHandle(down: PointerEvent, element: HTMLElement, ground: Ground, listener: DragListener): void {
  const id = element.dataset.behaviour!;
  const points = ground.points(id);
  const handle: Handle = element.classList.contains("block") ? "block" : element.dataset.edge ? "edge" : "stroke";
  const sync = points && (handle === "edge" ? points.get(element.dataset.edge!) : mainPoint(points));
  if (!points || !sync) return;
  down.preventDefault();
  element.focus();
  const selected = ground.selected();
  const group: ReadonlySet<string> = handle !== "edge" && selected.has(id) ? selected : new Set([id]);
  const moving =
    handle === "block" || group.size > 1
      ? [...ground.place.querySelectorAll<HTMLElement>("[data-behaviour]")].filter((each) =>
          group.has(each.dataset.behaviour!),
        )
      : [element];
  const snaps = ground.snaps(group);
  const bounds = handle === "edge" ? rangeOf(points, sync) : { from: -Infinity, to: Infinity };
  let snap: Snap | undefined;
  let by = 0;
  const move = (event: PointerEvent) => {
    const free = Math.min(
      Math.max(sync.planned + (event.clientX - down.clientX) * ground.pixel, bounds.from),
      bounds.to,
    );
    const over = handle === "edge" ? undefined : ground.wordUnder(event.clientX, event.clientY);
    const near = event.altKey ? undefined : nearest(snaps, free, SNAP_DISTANCE * ground.pixel);
    snap = over ?? (near && near.time >= bounds.from && near.time <= bounds.to ? near : undefined);
    by = (snap?.time ?? free) - sync.planned;
    for (const each of moving) each.style.translate = `${by / ground.pixel}px`;
    ground.showSnap(snap);
  };
  follow(down, element, move, (event) => {
    for (const each of moving) each.style.translate = "";
    ground.showSnap(undefined);
    if (!event) return;
    if (Math.abs(event.clientX - down.clientX) < CLICK_DISTANCE && !snap)
      listener.choose(id, event.shiftKey || event.ctrlKey || event.metaKey);
    else listener.moved({ behaviour: id, handle, sync, by, target: snap?.target ?? { kind: "free" } });
  });
}

/** Return the times [s] between which an edge can be dragged: those of its neighbours. */
function rangeOf(points: Points, edge: Sync): { from: number; to: number } {
  const main = mainPoint(points);
  const names = ["start", "ready", "strokeStart", "attackPeak", "stroke", "strokeEnd", "relax", "end"];
  const order = [...edgesOf(points), ...(main && !edgesOf(points).includes(main) ? [main] : [])].sort(
    (a, b) => names.indexOf(a.sync) - names.indexOf(b.sync),
  );
  const at = order.indexOf(edge);
  const before = order.slice(0, at).findLast(({ planned }) => planned < edge.planned);
  const after = order.slice(at + 1).find(({ planned }) => planned > edge.planned);
  return { from: (before?.planned ?? -MIN_PHASE) + MIN_PHASE, to: (after?.planned ?? Infinity) - MIN_PHASE };
}

/** Select behaviours by a rectangle; a click seeks. */
function dragBand(down: PointerEvent, ground: Ground, listener: DragListener): void {
  const { place } = ground;
  const area = place.getBoundingClientRect();
  const band = make("div", { class: "band" });
  const inside = () => {
    const own = band.getBoundingClientRect();
    const blocks = [...place.querySelectorAll<HTMLElement>(".block")];
    const hit = blocks.filter((block) => {
      const other = block.getBoundingClientRect();
      return other.left < own.right && other.right > own.left && other.top < own.bottom && other.bottom > own.top;
    });
    return [...new Set(hit.map((block) => block.dataset.behaviour!))];
  };
  const corner = (event: PointerEvent) => ({
    x: event.clientX - area.left + place.scrollLeft,
    y: event.clientY - area.top + place.scrollTop,
  });
  const begun = corner(down);
  const move = (event: PointerEvent) => {
    const now = corner(event);
    if (!band.isConnected && Math.hypot(now.x - begun.x, now.y - begun.y) < CLICK_DISTANCE) return;
    if (!band.isConnected) place.append(band);
    band.style.left = `${Math.min(begun.x, now.x)}px`;
    band.style.top = `${Math.min(begun.y, now.y)}px`;
    band.style.width = `${Math.abs(now.x - begun.x)}px`;
    band.style.height = `${Math.abs(now.y - begun.y)}px`;
  };
  follow(down, place, move, (event) => {
    const chosen = band.isConnected ? inside() : null;
    band.remove();
    if (!event) return;
    if (chosen) listener.chooseAll(chosen, event.shiftKey);
    else listener.seek(ground.timeAt(event.clientX));
  });
}
