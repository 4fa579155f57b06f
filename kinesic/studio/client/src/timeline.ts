// Timeline: spoken words, and a track per body part whose behaviours can be dragged and selected.
import { make } from "./dom.ts";
import { outcomeWords, typeWords } from "./plain_words.ts";
import { type Drawing, drawTrack } from "./tracks/blocks.ts";
import { beginDrag, type DragListener, type Ground } from "./tracks/drags.ts";
import { layOut } from "./tracks/layout.ts";
import { type Points, pointsOf } from "./tracks/phases.ts";
import { drawPoses, type PoseListener } from "./tracks/pose_row.ts";
import { listSnaps, nearest, type Snap } from "./tracks/snapping.ts";
import { listWords, type Word } from "./tracks/words.ts";
import { Zoom } from "./tracks/zoom.ts";
import type { Draft, GestureDraft } from "./types.ts";
import { drawWaveform } from "./waveform.ts";

const WORD_ROW_MARGIN = 4; // [CSS pixels] below the words in which a drop still hits them
const PALETTE_SNAP = 9; // [CSS pixels]

export class Timeline implements Ground {
  private draft: Draft | null = null;
  private words: Word[] = [];
  private known: ReadonlyMap<string, Points> = new Map();
  private chosen: ReadonlySet<string> = new Set();
  private readonly zoom: Zoom;
  private readonly head = make("div", { class: "playhead" });
  private readonly line = make("div", { class: "snap" });

  constructor(
    readonly place: HTMLElement,
    private readonly figures: { draw(gesture: string): Element | null },
    listener: DragListener,
    private readonly poses: PoseListener,
  ) {
    this.zoom = new Zoom(place, () => this.duration);
    place.addEventListener("pointerdown", (event) => beginDrag(event, this, listener));
    place.addEventListener("click", (event) => {
      const block = (event.target as Element).closest<HTMLElement>(".block, .unplaced");
      const isKey = event.detail === 0; // clicks of the pointer are ends of drags
      if (block && (isKey || block.matches(".unplaced"))) listener.choose(block.dataset.behaviour!, event.shiftKey);
    });
  }

  show(draft: Draft, chosen: ReadonlySet<string>): void {
    this.draft = draft;
    this.chosen = chosen;
    this.words = listWords(draft);
    this.known = pointsOf(draft);
    const { rows, unplaced } = layOut(draft);
    const drawing: Drawing = {
      duration: this.duration,
      selected: chosen,
      picture: (gesture) => this.figures.draw(gesture),
      percent: (time) => `${(100 * time) / this.duration}%`,
    };
    const tracks = rows.map((row) => drawTrack(row, drawing, row.track === "voice" ? this.sounds(draft) : []));
    const all = [this.wordRow(), this.poseRow(draft), ...tracks, this.unplacedRow(unplaced)];
    const inner = make("div", { class: "inner" }, ...all.filter((row) => row !== null), this.head, this.line);
    const focus = this.focused;
    const { scrollLeft, scrollTop } = this.place;
    this.place.replaceChildren(inner);
    this.zoom.spread();
    this.place.scrollTo(scrollLeft, scrollTop);
    this.makeReachable();
    if (focus) this.place.querySelector<HTMLElement>(focus)?.focus({ preventScroll: true });
  }

  /** Show the time [s]. */
  at(time: number): void {
    this.head.style.left = `calc(var(--names) + (100% - var(--names)) * ${time / this.duration})`;
    this.zoom.follow(this.head);
  }

  /** Zoom by a factor, or show everything. */
  zoomBy(factor: number | null): void {
    this.zoom.by(factor);
  }

  focusBlock(behaviour: string): void {
    this.place.querySelector<HTMLElement>(`[data-block="${CSS.escape(behaviour)}"]`)?.focus();
  }

  // ---- geometry of drags --------------------------------------------------------------------------------------

  get pixel(): number {
    return this.duration / Math.max(this.zoom.lane().width, 1);
  }

  points(behaviour: string): Points | undefined {
    return this.known.get(behaviour);
  }

  selected(): ReadonlySet<string> {
    return this.chosen;
  }

  timeAt(x: number): number {
    return this.zoom.timeAt(x);
  }

  snaps(dragged: ReadonlySet<string>): readonly Snap[] {
    return this.draft ? listSnaps(this.draft, this.words, dragged) : [];
  }

  wordUnder(x: number, y: number): Snap | undefined {
    const row = this.place.querySelector(".words")?.getBoundingClientRect();
    if (!row || y > row.bottom + WORD_ROW_MARGIN || y < row.top - WORD_ROW_MARGIN) return undefined;
    const time = this.timeAt(x);
    const word = this.words.find(({ start, end }) => start <= time && time <= end);
    return word && { time: word.start, target: { kind: "word", word }, says: word.text };
  }

  /** Return where something new would be dropped: a word, another snap, or any time; null outside. */
  dropAt(x: number, y: number): Snap | null {
    const area = this.place.getBoundingClientRect();
    if (x < area.left || x > area.right || y < area.top || y > area.bottom) return null;
    const time = this.timeAt(x);
    const snap = this.wordUnder(x, y) ?? nearest(this.snaps(new Set()), time, PALETTE_SNAP * this.pixel);
    return snap ?? { time, target: { kind: "free" }, says: `${time.toFixed(2)} s` };
  }

  /** Show the time and the word at which a drag would end. */
  showSnap(snap: Snap | undefined): void {
    this.line.classList.toggle("shown", snap !== undefined);
    if (snap) {
      this.line.dataset.says = snap.says;
      this.line.style.left = `calc(var(--names) + (100% - var(--names)) * ${snap.time / this.duration})`;
    }
    const word = snap?.target.kind === "word" ? snap.target.word : null;
    for (const each of this.place.querySelectorAll<HTMLElement>(".word"))
      each.classList.toggle("chosen", word !== null && this.words[Number(each.dataset.word)] === word);
  }

  // ---- rows ---------------------------------------------------------------------------------------------------

  private get duration(): number {
    return Math.max(this.draft?.duration ?? 1, 0.1);
  }

  /** Selector of the focused element of the timeline, by which it is found after drawing. */
  private get focused(): string | null {
    const { activeElement: active } = document;
    if (!(active instanceof HTMLElement) || !this.place.contains(active)) return null;
    const { behaviour, edge, stroke } = active.dataset;
    if (!behaviour) return null;
    const own = `[data-behaviour="${CSS.escape(behaviour)}"]`;
    return edge ? `${own}[data-edge="${edge}"]` : stroke ? `${own}.stroke` : `${own}.block`;
  }

  /** Let the Tab key reach the first block if none is selected. */
  private makeReachable(): void {
    const reachable = this.place.querySelector('.block[tabindex="0"]');
    if (!reachable) this.place.querySelector(".block[data-block]")?.setAttribute("tabindex", "0");
  }

  private poseRow(draft: Draft): HTMLElement | null {
    return "keys" in draft ? drawPoses((draft as GestureDraft).times, this.duration, this.poses) : null;
  }

  private wordRow(): HTMLElement | null {
    if (!this.words.length) return null;
    const lane = make("div", { class: "lane words" });
    this.words.forEach((word, k) => {
      const shown = make("span", { class: "word", "data-word": String(k), title: word.text }, word.text);
      shown.style.left = `${(100 * word.start) / this.duration}%`;
      shown.style.width = `${(100 * (word.end - word.start)) / this.duration}%`;
      lane.append(shown);
    });
    return make("div", { class: "row said" }, make("span", { class: "name" }, "words"), lane);
  }

  /** Waveform, phonemes and accents of the voice. */
  private sounds(draft: Draft): Element[] {
    const wave = make("div", { class: "sound", "aria-hidden": "true" });
    if (draft.loudness) {
      const peaks = Uint8Array.from(atob(draft.loudness), (letter) => letter.charCodeAt(0));
      wave.append(drawWaveform(peaks, Math.ceil(this.duration * draft.rate)));
    }
    const mark = (time: number, made: HTMLElement) => {
      made.style.left = `${(100 * time) / this.duration}%`;
      wave.append(made);
    };
    for (const [symbol, start] of draft.phonemes) mark(start, make("span", {}, symbol));
    for (const time of draft.accents) mark(time, make("i", { class: "accent" }));
    return [wave];
  }

  private unplacedRow(unplaced: Draft["behaviours"]): HTMLElement | null {
    if (!unplaced.length) return null;
    const buttons = unplaced.map((behaviour) => {
      const { id, type, label, outcome } = behaviour;
      const title = [`${typeWords(type)} ${label}`, outcomeWords(behaviour)].filter(Boolean).join(": ");
      const pressed = String(this.chosen.has(id));
      const attributes = { type: "button", title, "data-behaviour": id, "data-block": id, "aria-pressed": pressed };
      return make("button", { class: `unplaced ${outcome}`, ...attributes }, label || id);
    });
    return make("div", { class: "row" }, make("span", { class: "name" }, "no times"), make("div", {}, ...buttons));
  }
}
