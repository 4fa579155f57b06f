// Edits of the timeline: what drags, keys and menus do with the selected behaviours.
import { type Anchor, blockTime } from "../anchors.ts";
import { mark, remove, shift, tie } from "../edits.ts";
import { addDropped } from "../palette.ts";
import type { Draft } from "../types.ts";
import { type Clip, copyAll, paste } from "./clipboard.ts";
import type { Move } from "./drags.ts";
import { dependsOn, moveAll, moveOnto, stretch } from "./group_edits.ts";
import { mainPoint, type Points, pointsOf, spanOf } from "./phases.ts";
import { Selection } from "./selection.ts";
import type { Snap, Target } from "./snapping.ts";

/** Parts of the page that the edits need. */
export interface TrackDesk {
  text(): string;
  edit(text: string): void;
  draft(): Draft | null;
  /** Whether the document is no BML that can be edited here. */
  locked(): boolean;
  /** Time of the slider [s]. */
  time(): number;
  /** The selection has changed. */
  chosen(): void;
  /** Tell the user what has happened, also by a screen reader. */
  say(text: string): void;
}

const GAP = 0.2; // [s] between behaviours and their duplicates

export class TrackEditing {
  readonly selection: Selection;
  private clip: Clip | null = null;
  private points: ReadonlyMap<string, Points> = new Map();
  private pending: readonly string[] = []; // ids to select when their draft arrives

  constructor(private readonly desk: TrackDesk) {
    this.selection = new Selection(() => desk.chosen());
  }

  get hasClip(): boolean {
    return this.clip !== null;
  }

  /** Use the points of a new draft, and select what was just pasted. */
  drafted(draft: Draft): void {
    this.points = pointsOf(draft);
    const existing = new Set(draft.behaviours.map(({ id }) => id));
    if (this.pending.length) this.selection.set(this.pending.filter((id) => existing.has(id)));
    else this.selection.keep(existing);
    this.pending = [];
  }

  /** Select behaviours that the next draft contains. */
  expect(ids: readonly string[]): void {
    this.pending = ids;
  }

  choose(id: string, isExtended: boolean): void {
    if (this.desk.locked()) return;
    if (isExtended) this.selection.extend(id);
    else this.selection.set([id]);
  }

  chooseAll(ids: readonly string[], isExtended: boolean): void {
    if (!this.desk.locked()) this.selection.set(isExtended ? [...this.selection.all, ...ids] : ids);
  }

  /** Apply a finished drag. */
  move({ behaviour, handle, sync, by, target }: Move): void {
    if (this.desk.locked()) return;
    const text = this.desk.text();
    const point = sync.sync;
    const isGroup = handle !== "edge" && this.selection.has(behaviour) && this.selection.all.size > 1;
    if (handle === "edge") {
      const main = mainPoint(this.points.get(behaviour) ?? new Map())?.sync ?? "start";
      this.desk.edit(stretch(text, behaviour, point, by, this.asked(behaviour), main));
    } else if (isGroup) this.shiftAll([...this.selection.all], by);
    else if (target.kind === "free" && handle === "block") this.shiftAll([behaviour], by);
    else if (target.kind === "free") this.desk.edit(shift(text, behaviour, point, by, this.inBlock(sync.asked)));
    else if (target.kind === "word" && handle === "stroke") {
      const { speech, mark: before, index } = target.word;
      const marked = mark(text, speech, before, index);
      this.desk.edit(tie(marked.text, behaviour, point, { speech, mark: marked.mark }));
    } else {
      const { text: marked, anchor } = this.anchorAt(text, target, this.inBlock(sync.planned + by), behaviour);
      this.desk.edit(moveOnto(marked, behaviour, point, anchor, this.asked(behaviour)));
    }
  }

  /** Add what is dropped from the palette or the list of gestures. */
  drop(value: string, snap: Snap): void {
    if (this.desk.locked()) {
      this.desk.say("open a document first; this is a gesture");
      return;
    }
    const { text, anchor } = this.anchorAt(this.desk.text(), snap.target, this.inBlock(snap.time));
    const added = addDropped(text, value, anchor);
    if (!added) return;
    this.pending = [added.id];
    this.desk.edit(added.text);
    this.desk.say(`${added.id} added at ${snap.says}`);
  }

  /** Return the anchor of a target, and the text with the mark that it needs. */
  anchorAt(text: string, target: Target, time: number, behaviour?: string): { text: string; anchor: Anchor } {
    const free = { text, anchor: blockTime(time) };
    if (target.kind === "free") return free;
    if (target.kind === "word") {
      const { speech, mark: before, index } = target.word;
      const marked = mark(text, speech, before, index);
      return { text: marked.text, anchor: { reference: `${speech}:${marked.mark}`, offset: 0 } };
    }
    if (target.kind === "accent")
      return { text, anchor: { reference: `${target.speech}:${target.mark}`, offset: target.offset } };
    if (behaviour && dependsOn(text, target.behaviour, new Set([behaviour]))) return free;
    return { text, anchor: { reference: `${target.behaviour}:${target.sync}`, offset: 0 } };
  }

  /** Move the selected behaviours by some seconds. */
  nudge(by: number): void {
    const ids = this.movable;
    if (!ids.length) return;
    this.shiftAll(ids, by);
    this.desk.say(`${count(ids)} moved by ${by.toFixed(2)} s`);
  }

  copy(): void {
    const ids = this.movable;
    if (!ids.length) return;
    this.clip = this.clipOf(ids);
    this.desk.say(`${count(ids)} copied`);
  }

  cut(): void {
    this.copy();
    this.remove();
  }

  /** Paste at a time [s], by default that of the slider. */
  paste(time = this.desk.time()): void {
    if (this.clip) this.insert(this.clip, this.inBlock(time), "pasted");
  }

  /** Insert copies of the selected behaviours after them. */
  duplicate(): void {
    const ids = this.movable;
    if (!ids.length) return;
    const ends = ids.flatMap((id) => (this.points.has(id) ? [spanOf(this.points.get(id)!).to] : []));
    const end = ends.length ? Math.max(...ends) : this.desk.time();
    this.insert(this.clipOf(ids), this.inBlock(end + GAP), "duplicated");
  }

  remove(): void {
    const ids = this.movable;
    if (!ids.length) return;
    this.desk.edit(ids.reduce(remove, this.desk.text()));
    this.selection.set([]);
    this.desk.say(`${count(ids)} deleted`);
  }

  selectAll(): void {
    this.chooseAll(this.desk.draft()?.behaviours.map(({ id }) => id) ?? [], false);
    this.desk.say(`${count(this.movable)} selected`);
  }

  /** Return the behaviour before or after another one in time. */
  neighbour(id: string, step: 1 | -1): string | undefined {
    const order = [...this.points]
      .map(([each, points]) => ({ each, from: spanOf(points).from }))
      .sort((a, b) => a.from - b.from)
      .map(({ each }) => each);
    return order[order.indexOf(id) + step];
  }

  private get movable(): string[] {
    return this.desk.locked() ? [] : [...this.selection.all];
  }

  private inBlock(time: number): number {
    return Math.max(0, time - (this.desk.draft()?.zero ?? 0));
  }

  /** Requested block times [s] of a behaviour's points. */
  private asked(id: string): Map<string, number> {
    const zero = this.desk.draft()?.zero ?? 0;
    return new Map([...(this.points.get(id) ?? [])].map(([name, sync]) => [name, sync.asked - zero]));
  }

  private shiftAll(ids: readonly string[], by: number): void {
    const starts = new Map(ids.map((id) => [id, this.asked(id).get("start") ?? 0]));
    this.desk.edit(moveAll(this.desk.text(), starts, by));
  }

  private clipOf(ids: readonly string[]): Clip {
    return copyAll(this.desk.text(), ids, new Map(ids.map((id) => [id, this.asked(id)])));
  }

  private insert(clip: Clip, time: number, did: string): void {
    if (this.desk.locked()) return;
    const pasted = paste(this.desk.text(), clip, time);
    this.pending = pasted.ids;
    this.desk.edit(pasted.text);
    this.desk.say(`${count(pasted.ids)} ${did}`);
  }
}

const count = (ids: readonly string[]): string => (ids.length === 1 ? ids[0]! : `${ids.length} behaviours`);
