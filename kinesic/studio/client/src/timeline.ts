// Timeline: spoken words, and a row per behaviour with strokes that can be dragged onto words.
import { make } from "./dom.ts";
import type { Anchor } from "./edits.ts";
import type { Draft, Sync } from "./types.ts";
import { drawWaveform } from "./waveform.ts";

export interface Word {
  speech: string;
  mark: string; // preceding mark
  index: number; // index among the words after the mark
  text: string;
  start: number;
  end: number;
}

export interface Moved {
  behaviour: string;
  point: string;
  /** Word under the dropped point, or its shift [s]. */
  onto: Word | { by: number; asked: number };
}

const SNAP_DISTANCE = 14; // [CSS pixels] distance from the start of a word
const MIN_SCALE = 48; // [CSS pixels/s] smallest scale; long documents scroll
const MAX_SCALE = 400; // [CSS pixels/s] largest scale
const PHONEME_SCALE = 130; // [CSS pixels/s] scale from which phonemes are shown
const KEY_STEP = 0.05; // [s] step of an arrow key
const CORES = [
  ["strokeStart", "strokeEnd"],
  ["ready", "relax"],
  ["attackPeak", "relax"],
] as const;
const MIN_DEVIATION = 0.02; // [s] smallest shown deviation from the requested time
const STROKES = ["stroke", "attackPeak", "ready", "start"];

/** Return the words of a draft; times between two marks are proportional to letters. */
export function listWords(draft: Draft): Word[] {
  return draft.words.flatMap(({ speech, mark, text, start, end }) => {
    const perLetter = (end - start) / Math.max(1, text.length);
    return [...text.matchAll(/\S+/g)].map((match, index) => ({
      speech,
      mark,
      index,
      text: match[0],
      start: start + perLetter * match.index,
      end: start + perLetter * (match.index + match[0].length),
    }));
  });
}

/** Return the anchor of a word that has a mark. */
export const wordAnchor = (word: Word): Anchor => ({ speech: word.speech, mark: word.mark });

export class Timeline {
  private draft: Draft | null = null;
  private words: Word[] = [];
  private scale = MIN_SCALE; // [CSS pixels/s] smallest scale
  private scrolls = false; // whether it is wider than its pane
  private readonly head = make("div", { class: "playhead" });

  constructor(
    private readonly place: HTMLElement,
    private readonly listener: { moved(moved: Moved): void; seek(time: number): void; choose(behaviour: string): void },
  ) {
    place.addEventListener("pointerdown", (event) => {
      const lane = (event.target as HTMLElement).closest(".lane");
      if (lane && event.target === lane) this.listener.seek(this.timeAt(event.clientX));
    });
    place.addEventListener("wheel", (event) => event.ctrlKey && this.zoomAt(event), { passive: false });
    new ResizeObserver(() => this.spread()).observe(place);
  }

  show(draft: Draft, chosen: string | null): void {
    this.draft = draft;
    this.words = listWords(draft);
    const rows = [this.wordRow(), this.voiceRow(draft), ...draft.behaviours.map((each) => this.row(each, chosen))];
    const inner = make("div", { class: "inner" }, ...rows.filter((row) => row !== null), this.head);
    const { scrollLeft, scrollTop } = this.place;
    this.place.replaceChildren(inner);
    this.spread();
    this.place.scrollTo(scrollLeft, scrollTop);
  }

  /** Zoom around the pointer. */
  private zoomAt(event: WheelEvent): void {
    event.preventDefault();
    const time = this.timeAt(event.clientX);
    const now = this.lane().width / this.duration;
    this.scale = Math.min(Math.max(now * Math.exp(-0.002 * event.deltaY), MIN_SCALE), MAX_SCALE);
    this.spread();
    this.place.scrollLeft += ((time / this.duration) * this.lane().width + this.lane().left - event.clientX) | 0;
  }

  /** Apply the scale. */
  private spread(): void {
    const inner = this.place.querySelector<HTMLElement>(".inner");
    if (!inner) return;
    inner.style.minWidth = `calc(var(--names) + ${Math.round(this.duration * this.scale)}px)`;
    inner.classList.toggle("dense", this.lane().width / this.duration < PHONEME_SCALE);
    this.scrolls = this.place.scrollWidth > this.place.clientWidth;
  }

  /** Show the time [s]. */
  at(time: number): void {
    this.head.style.left = `calc(var(--names) + (100% - var(--names)) * ${time / this.duration})`;
    if (!this.scrolls) return;
    const [place, head] = [this.place.getBoundingClientRect(), this.head.getBoundingClientRect()];
    const names = this.lane().left + this.place.scrollLeft - place.left;
    const seen = head.left >= place.left + names && head.left <= place.right;
    if (!seen) this.place.scrollLeft += head.left - place.left - names - 20;
  }

  private get duration(): number {
    return Math.max(this.draft?.duration ?? 1, 0.1);
  }

  private percent(time: number): string {
    return `${(100 * time) / this.duration}%`;
  }

  private lane(): DOMRect {
    return (this.place.querySelector(".lane") ?? this.place).getBoundingClientRect();
  }

  private timeAt(x: number): number {
    const area = this.lane();
    return Math.min(Math.max((x - area.left) / area.width, 0), 1) * this.duration;
  }

  private wordRow(): HTMLElement | null {
    if (!this.words.length) return null;
    const lane = make("div", { class: "lane words" });
    this.words.forEach((word, k) => {
      const shown = make("span", { class: "word", "data-word": String(k), title: word.text }, word.text);
      shown.style.left = this.percent(word.start);
      shown.style.width = this.percent(word.end - word.start);
      lane.append(shown);
    });
    return make("div", { class: "row said" }, make("span", { class: "name" }, "words"), lane);
  }

  /** Waveform and phonemes of the voice. */
  private voiceRow(draft: Draft): HTMLElement | null {
    if (!draft.phonemes.length && !draft.loudness) return null;
    const lane = make("div", { class: "lane voice", "aria-hidden": "true" });
    if (draft.loudness) {
      const peaks = Uint8Array.from(atob(draft.loudness), (letter) => letter.charCodeAt(0));
      lane.append(drawWaveform(peaks, Math.ceil(this.duration * draft.rate)));
    }
    for (const [symbol, start] of draft.phonemes) {
      const shown = make("span", {}, symbol);
      shown.style.left = this.percent(start);
      lane.append(shown);
    }
    return make("div", { class: "row" }, make("span", { class: "name" }, "voice"), lane);
  }

  private row(behaviour: Draft["behaviours"][number], chosen: string | null): HTMLElement | null {
    const { id, type, outcome, why } = behaviour;
    const syncs = (this.draft?.syncs ?? []).filter((sync) => sync.behaviour === id);
    const about = outcome === "realised" ? type : `${type}: ${outcome}${why ? `, ${why}` : ""}`;
    const lane = make("div", { class: "lane" });
    if (syncs.length) lane.append(...this.block(id, type, syncs));
    else if (type === "speech") return null;
    const name = make("button", { class: `name ${outcome}`, title: about, "aria-pressed": String(id === chosen) }, id);
    name.addEventListener("click", () => this.listener.choose(id));
    return make("div", { class: "row", "data-row": id }, name, lane);
  }

  private block(id: string, type: string, syncs: Sync[]): HTMLElement[] {
    const at = new Map(syncs.map((sync) => [sync.sync, sync]));
    const times = syncs.map((sync) => sync.planned);
    const [begin, end] = [Math.min(...times), Math.max(...times)];
    const block = make("div", { class: `block ${type}` });
    block.style.left = this.percent(begin);
    block.style.width = this.percent(end - begin);
    const core = CORES.find(([first, last]) => at.has(first) && at.has(last));
    if (core) {
      const [from, to] = core.map((name) => at.get(name)!.planned) as [number, number];
      const phase = make("div", { class: "core" });
      phase.style.left = `${(100 * (from - begin)) / (end - begin || 1)}%`;
      phase.style.width = `${(100 * (to - from)) / (end - begin || 1)}%`;
      block.append(phase);
    }
    const stroke = STROKES.map((name) => at.get(name)).find((sync) => sync !== undefined);
    const start = at.get("start");
    if (start) this.draggable(block, id, start);
    return stroke ? [block, ...this.strokeOf(id, stroke)] : [block];
  }

  private strokeOf(id: string, stroke: Sync): HTMLElement[] {
    const handle = make("button", {
      class: "stroke",
      role: "slider",
      "aria-label": `${stroke.sync} of ${id}`,
      "aria-valuenow": stroke.planned.toFixed(2),
      "aria-valuemin": "0",
      "aria-valuemax": this.duration.toFixed(2),
      "data-stroke": id,
      title: `${stroke.sync} of ${id} at ${stroke.planned.toFixed(2)} s: drag it onto a word`,
    });
    handle.style.left = this.percent(stroke.planned);
    this.draggable(handle, id, stroke);
    handle.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -KEY_STEP, ArrowRight: KEY_STEP }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.listener.moved({ behaviour: id, point: stroke.sync, onto: { by, asked: stroke.asked } });
    });
    if (Math.abs(stroke.asked - stroke.planned) < MIN_DEVIATION) return [handle];
    const asked = make("i", { class: "asked", title: `requested: ${stroke.asked.toFixed(2)} s` });
    asked.style.left = this.percent(stroke.asked);
    return [handle, asked];
  }

  /** Make a sync point draggable: strokes snap to words, all points can be shifted. */
  private draggable(element: HTMLElement, behaviour: string, sync: Sync): void {
    element.addEventListener("pointerdown", (down) => {
      if (down.button !== 0) return;
      down.preventDefault();
      element.setPointerCapture(down.pointerId);
      element.focus();
      const begun = down.clientX;
      const left = element.style.left;
      const snaps = element.classList.contains("stroke");
      let word: Word | undefined;
      const move = (event: PointerEvent) => {
        const by = event.clientX - begun;
        element.style.left = `calc(${left} + ${by}px)`;
        word = snaps && Math.abs(by) > 2 ? this.wordAt(event.clientX, event.clientY) : undefined;
        for (const each of this.place.querySelectorAll<HTMLElement>(".word"))
          each.classList.toggle("chosen", word !== undefined && this.words[Number(each.dataset.word)] === word);
      };
      const drop = (event: PointerEvent) => {
        element.removeEventListener("pointermove", move);
        element.style.left = left;
        const by = ((event.clientX - begun) / this.lane().width) * this.duration;
        if (event.type === "pointercancel" || Math.abs(event.clientX - begun) < 3) this.listener.choose(behaviour);
        else this.listener.moved({ behaviour, point: sync.sync, onto: word ?? { by, asked: sync.asked } });
      };
      element.addEventListener("pointermove", move);
      element.addEventListener("pointerup", drop, { once: true });
    });
  }

  /** Return the word under the pointer or with a start close to it. */
  private wordAt(x: number, y: number): Word | undefined {
    const row = this.place.querySelector(".words")?.getBoundingClientRect();
    if (!row) return undefined;
    const time = this.timeAt(x);
    if (y <= row.bottom + 4) return this.words.find((word) => word.start <= time && time <= word.end);
    const near = (SNAP_DISTANCE / this.lane().width) * this.duration;
    return this.words.find((word) => Math.abs(word.start - time) < near);
  }
}
