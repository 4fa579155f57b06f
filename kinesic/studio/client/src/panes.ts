// Borders between the panes of the page, which are dragged or moved by arrow keys; the browser remembers them.
import { make } from "./dom.ts";
import { recall, remember } from "./remembered.ts";

interface Pane {
  name: string;
  label: string;
  /** Whether the border is a vertical line. */
  isVertical: boolean;
  /** Whether the pane lies before its border, left or above. */
  isBefore: boolean;
  usual: number; // [%] of the page
  min: number;
  max: number;
}

const PANES: readonly Pane[] = [
  { name: "document", label: "Width of the document", isVertical: true, isBefore: true, usual: 32, min: 12, max: 60 },
  { name: "details", label: "Width of the details", isVertical: true, isBefore: false, usual: 20, min: 12, max: 45 },
  {
    name: "timeline",
    label: "Height of the timeline",
    isVertical: false,
    isBefore: false,
    usual: 38,
    min: 15,
    max: 80,
  },
];
const KEY_STEP = 2; // [%] of an arrow key

/** Add a border to each pane. */
export function listenToPanes(): void {
  const main = document.querySelector("main");
  if (main) for (const pane of PANES) main.append(drawBorder(pane, main));
}

function drawBorder(pane: Pane, main: HTMLElement): HTMLElement {
  const { name, label, isVertical, isBefore, usual, min, max } = pane;
  const border = make("div", {
    class: `border ${name}`,
    role: "separator",
    tabindex: "0",
    "aria-label": label,
    "aria-controls": name,
    "aria-orientation": isVertical ? "vertical" : "horizontal",
    "aria-valuemin": String(min),
    "aria-valuemax": String(max),
    title: `${label}: drag it, or press the arrow keys; a double click resets it`,
  });
  let size = recall(`pane-${name}`, usual, min, max);
  const show = (percent: number) => {
    size = Math.min(Math.max(percent, min), max);
    main.style.setProperty(`--${name}`, `${size}%`);
    border.setAttribute("aria-valuenow", size.toFixed(0));
  };
  const set = (percent: number) => {
    show(percent);
    remember(`pane-${name}`, size);
  };
  show(size);
  const sign = isBefore ? 1 : -1;
  border.addEventListener("keydown", (event) => {
    const steps: Record<string, number> = isVertical ? { ArrowLeft: -1, ArrowRight: 1 } : { ArrowUp: -1, ArrowDown: 1 };
    const step = steps[event.key];
    const ends: Record<string, number> = { Home: min, End: max };
    const to = step === undefined ? ends[event.key] : size + sign * step * KEY_STEP;
    if (to === undefined) return;
    event.preventDefault();
    set(to);
  });
  border.addEventListener("dblclick", () => set(usual));
  border.addEventListener("pointerdown", (down) => {
    down.preventDefault();
    border.focus();
    border.setPointerCapture(down.pointerId);
    const ended = new AbortController();
    const options = { signal: ended.signal };
    const move = ({ clientX, clientY }: PointerEvent) => {
      const area = main.getBoundingClientRect();
      const share = isVertical ? (clientX - area.left) / area.width : (clientY - area.top) / area.height;
      set(100 * (isBefore ? share : 1 - share));
    };
    border.addEventListener("pointermove", move, options);
    for (const end of ["pointerup", "pointercancel"] as const)
      border.addEventListener(end, () => ended.abort(), options);
  });
  return border;
}
