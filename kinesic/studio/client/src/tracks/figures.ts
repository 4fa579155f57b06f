// Stick figures of the gestures: still at the stroke in lists and tracks, and moving in a preview.
import { byId, make } from "../dom.ts";
import { gestureWords } from "../plain_words.ts";

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = 0.4; // [s] still time between two loops of a preview
const HEAD_RADIUS = 17; // [units]
const GAP = 8; // [CSS pixels] between a preview and its row

/** Points of a figure: head, neck, trunk, then of each arm shoulder, elbow, wrist and finger tips. */
interface Figure {
  frames: Uint8Array;
  seconds: number;
  still: number;
}

interface FigureFile {
  fingers: number;
  frames: number;
  figures: Record<string, { frames: string; seconds: number; still: number }>;
}

export class Figures {
  private file: FigureFile | null = null;
  private readonly decoded = new Map<string, Figure>();
  private shown: { figure: Figure; begun: number; picture: SVGSVGElement } | null = null;

  /** Load the figures, and call `loaded` when they can be drawn. */
  constructor(loaded: () => void) {
    void this.load(loaded);
  }

  /** Return a picture of a gesture at its stroke; null if there is none. */
  draw(gesture: string): SVGSVGElement | null {
    const figure = this.find(gesture);
    if (!figure) return null;
    const picture = document.createElementNS(SVG, "svg");
    picture.setAttribute("class", "figure");
    picture.setAttribute("viewBox", "22 2 186 202");
    picture.setAttribute("aria-hidden", "true");
    for (const part of ["body", "fingers", "head"]) {
      const made = document.createElementNS(SVG, part === "head" ? "circle" : "path");
      made.setAttribute("class", `figure-${part}`);
      picture.append(made);
    }
    this.pose(picture, figure, figure.still);
    return picture;
  }

  /** Show a moving preview of a gesture beside an element; null hides it. */
  preview(gesture: string | null, beside?: Element): void {
    const place = byId("figure-preview");
    const figure = gesture === null ? undefined : this.find(gesture);
    const picture = gesture === null ? null : this.draw(gesture);
    place.hidden = !picture;
    this.shown = null;
    if (!figure || !picture || !beside) return;
    place.replaceChildren(picture, make("span", {}, gestureWords(gesture ?? "")));
    const [own, area] = [place.getBoundingClientRect(), beside.getBoundingClientRect()];
    const before = area.left - own.width - GAP;
    const left = before >= 0 ? before : Math.min(area.right + GAP, innerWidth - own.width);
    place.style.left = `${left}px`;
    place.style.top = `${Math.max(4, Math.min(area.top, innerHeight - own.height - 4))}px`;
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    this.shown = { figure, begun: performance.now(), picture };
    requestAnimationFrame(() => this.tick());
  }

  private async load(loaded: () => void): Promise<void> {
    const response = await fetch("figures.json");
    if (!response.ok) return;
    this.file = (await response.json()) as FigureFile;
    loaded();
  }

  private find(gesture: string): Figure | undefined {
    const known = this.decoded.get(gesture);
    const figures = this.file?.figures ?? {};
    const found = Object.hasOwn(figures, gesture) ? figures[gesture] : undefined;
    if (known || !found) return known;
    const figure = { ...found, frames: Uint8Array.from(atob(found.frames), (letter) => letter.charCodeAt(0)) };
    this.decoded.set(gesture, figure);
    return figure;
  }

  private tick(): void {
    if (!this.shown) return;
    const { figure, begun, picture } = this.shown;
    const time = ((performance.now() - begun) / 1000) % (figure.seconds + MARGIN);
    const last = (this.file?.frames ?? 1) - 1;
    this.pose(picture, figure, Math.min((time / figure.seconds) * last, last));
    requestAnimationFrame(() => this.tick());
  }

  /** Draw a figure at a frame, or between two. */
  private pose(picture: SVGSVGElement, figure: Figure, at: number): void {
    const fingers = this.file?.fingers ?? 0;
    const count = 3 + 2 * (3 + fingers);
    const [low, high] = [Math.floor(at), Math.ceil(at)];
    const unit = (k: number) => {
      const [a, b] = [figure.frames[2 * count * low + k]!, figure.frames[2 * count * high + k]!];
      return (a + (b - a) * (at - low)).toFixed(1);
    };
    const point = (k: number) => `${unit(2 * k)} ${unit(2 * k + 1)}`;
    const arms = [3, 3 + 3 + fingers];
    const [body, tips, head] = [...picture.children] as [Element, Element, Element];
    const shoulders = arms.map((k) => point(k)).join("L");
    body.setAttribute(
      "d",
      `M${point(1)}L${point(2)}M${shoulders}${arms.map((k) => `M${point(k)}L${point(k + 1)}L${point(k + 2)}`).join("")}`,
    );
    const hand = (k: number) =>
      Array.from({ length: fingers }, (_, n) => `M${point(k + 2)}L${point(k + 3 + n)}`).join("");
    tips.setAttribute("d", arms.map(hand).join(""));
    head.setAttribute("cx", unit(0));
    head.setAttribute("cy", unit(1));
    head.setAttribute("r", String(HEAD_RADIUS));
  }
}

/** Show previews of the gestures of a list while the pointer is over them or they have the focus. */
export function listenToPreviews(list: HTMLElement, figures: Figures): void {
  const gestureAt = (event: Event) => (event.target as Element).closest<HTMLElement>("[data-gesture]");
  const show = (event: Event) => {
    const row = gestureAt(event);
    figures.preview(row?.dataset.gesture ?? null, row ?? undefined);
  };
  for (const kind of ["pointerover", "focusin"] as const) list.addEventListener(kind, show);
  for (const kind of ["pointerleave", "focusout", "pointerdown"] as const)
    list.addEventListener(kind, () => figures.preview(null));
}
