// Commands on the selected behaviours, by keys and by a menu.
import { byId, make } from "../dom.ts";
import type { Timeline } from "../timeline.ts";
import type { TrackEditing } from "./editing.ts";

const KEY_STEP = 0.05; // [s] step of an arrow key
const FINE_STEP = 0.01; // [s] with Alt
const ZOOM_STEP = 1.4; // factor of a zoom button

/** Listen to the keys, the context menu and the zoom buttons of the timeline. */
export function listenToTracks(editing: TrackEditing, timeline: Timeline): void {
  document.addEventListener("keydown", (event) => {
    if (!isFree(event.target as HTMLElement)) return;
    const act = shortcut(event, editing, timeline);
    if (!act) return;
    event.preventDefault();
    act();
  });
  timeline.place.addEventListener("contextmenu", (event) => {
    event.preventDefault();
    openMenu(event, editing, timeline);
  });
  byId("zoom-in").addEventListener("click", () => timeline.zoomBy(ZOOM_STEP));
  byId("zoom-out").addEventListener("click", () => timeline.zoomBy(1 / ZOOM_STEP));
  byId("zoom-all").addEventListener("click", () => timeline.zoomBy(null));
}

/** Whether keys on an element belong to the timeline. */
function isFree(element: HTMLElement): boolean {
  return element === document.body || (element.closest("#rows") !== null && !element.matches("input, select"));
}

function shortcut(event: KeyboardEvent, editing: TrackEditing, timeline: Timeline): (() => void) | undefined {
  const { last } = editing.selection;
  if (event.ctrlKey || event.metaKey) {
    const commands: Record<string, () => void> = {
      a: () => editing.selectAll(),
      c: () => editing.copy(),
      x: () => editing.cut(),
      v: () => editing.paste(),
      d: () => editing.duplicate(),
      "+": () => timeline.zoomBy(ZOOM_STEP),
      "-": () => timeline.zoomBy(1 / ZOOM_STEP),
    };
    return commands[event.key.toLowerCase()];
  }
  if (event.key === "Escape") {
    if (last !== undefined) editing.chooseAll([], false); // the key also stops the robot
    return undefined;
  }
  const walk = (step: 1 | -1) => {
    const focused = (document.activeElement as HTMLElement | null)?.dataset.behaviour ?? last;
    const next = focused === undefined ? undefined : editing.neighbour(focused, step);
    if (next === undefined) return;
    editing.chooseAll([next], event.shiftKey);
    timeline.focusBlock(next);
  };
  const step = event.altKey ? FINE_STEP : KEY_STEP;
  const isEmpty = last === undefined;
  const keys: Record<string, () => void> = {
    ArrowLeft: () => (event.shiftKey || isEmpty ? walk(-1) : editing.nudge(-step)),
    ArrowRight: () => (event.shiftKey || isEmpty ? walk(1) : editing.nudge(step)),
    ArrowUp: () => walk(-1),
    ArrowDown: () => walk(1),
    Delete: () => editing.remove(),
    Backspace: () => editing.remove(),
  };
  const isNudge = event.target !== document.body || event.key === "Delete";
  return isNudge ? keys[event.key] : undefined;
}

/** Open the menu of the commands at the pointer, or at the focused behaviour if a key asks for it. */
function openMenu(event: MouseEvent, editing: TrackEditing, timeline: Timeline): void {
  const block = (event.target as Element).closest<HTMLElement>("[data-behaviour]");
  const id = block?.dataset.behaviour;
  if (id && !editing.selection.has(id)) editing.chooseAll([id], false);
  const time = timeline.timeAt(event.clientX);
  const some = editing.selection.last !== undefined;
  const commands: [string, string, boolean, () => void][] = [
    ["Copy", "Ctrl C", some, () => editing.copy()],
    ["Cut", "Ctrl X", some, () => editing.cut()],
    ["Paste here", "", editing.hasClip, () => editing.paste(time)],
    ["Duplicate", "Ctrl D", some, () => editing.duplicate()],
    ["Delete", "Del", some, () => editing.remove()],
    ["Move earlier", "←", some, () => editing.nudge(-KEY_STEP)],
    ["Move later", "→", some, () => editing.nudge(KEY_STEP)],
    ["Select all", "Ctrl A", true, () => editing.selectAll()],
    ["Zoom in", "Ctrl +", true, () => timeline.zoomBy(ZOOM_STEP)],
    ["Zoom out", "Ctrl −", true, () => timeline.zoomBy(1 / ZOOM_STEP)],
  ];
  showMenu(event, commands, () => id && timeline.focusBlock(id));
}

function showMenu(
  event: MouseEvent,
  commands: readonly (readonly [string, string, boolean, () => void])[],
  closed: () => void,
): void {
  document.querySelector("#track-menu")?.remove();
  const menu = make("div", { id: "track-menu", role: "menu", "aria-label": "Selected behaviours" });
  const ended = new AbortController();
  const close = () => {
    ended.abort();
    menu.remove();
    closed();
  };
  for (const [words, keys, isPossible, act] of commands) {
    const item = make("button", { type: "button", role: "menuitem", tabindex: "-1" }, words, make("kbd", {}, keys));
    item.disabled = !isPossible;
    item.addEventListener("click", () => {
      close();
      act();
    });
    menu.append(item);
  }
  menu.addEventListener("keydown", (key) => {
    const items = [...menu.querySelectorAll<HTMLButtonElement>("button:not(:disabled)")];
    const at = items.indexOf(document.activeElement as HTMLButtonElement);
    const steps: Record<string, number> = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: -1 };
    const to = steps[key.key];
    if (to !== undefined) items.at(to % items.length)?.focus();
    if (key.key === "Tab" || key.key === "Escape") close();
    if (to !== undefined || key.key === "Tab") key.preventDefault();
  });
  document.addEventListener("pointerdown", (down) => !menu.contains(down.target as Node) && close(), {
    signal: ended.signal,
  });
  byId("timeline").append(menu);
  const { width, height } = menu.getBoundingClientRect();
  menu.style.left = `${Math.max(0, Math.min(event.clientX, innerWidth - width))}px`;
  menu.style.top = `${Math.max(0, Math.min(event.clientY, innerHeight - height))}px`;
  menu.querySelector<HTMLButtonElement>("button:not(:disabled)")?.focus();
}
