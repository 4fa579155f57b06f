// New behaviours at the time of the slider: gestures, entries of the palette, and pauses.
import { blockTime } from "./anchors.ts";
import { type Added, appendGesture } from "./edits.ts";
import { addDropped } from "./palette.ts";
import type { PlannedDocument } from "./planned_document.ts";
import { pauseBefore } from "./tracks/pauses.ts";
import type { Word } from "./tracks/words.ts";

/** Parts of the page that insertions need. */
export interface InsertionListener {
  text(): string;
  edit(text: string): void;
  /** Whether the document is a gesture, to which nothing can be added. */
  isGesture(): boolean;
  /** Time of the slider [s]. */
  time(): number;
  /** Selected word, or the spoken word at a time [s]. */
  wordAt(time: number): Word | undefined;
  /** Select a behaviour when it is planned. */
  expect(id: string): void;
  say(text: string): void;
}

export class Insertion {
  constructor(
    private readonly plan: PlannedDocument,
    private readonly listener: InsertionListener,
  ) {}

  gesture(lexeme: string): void {
    this.add((text, time) => appendGesture(text, lexeme, blockTime(time)));
  }

  /** Add what is pressed in the palette. */
  paletteEntry(value: string): void {
    this.add((text, time) => addDropped(text, value, blockTime(time)));
  }

  /** Add a behaviour by an edit of the text at a block time [s], and select it. */
  add(edit: (text: string, time: number) => Added | null): void {
    if (this.listener.isGesture()) {
      this.listener.say("open a document first; this is a gesture");
      return;
    }
    const added = edit(this.listener.text(), Math.max(0, this.listener.time() - this.plan.zero));
    if (!added) return;
    this.listener.expect(added.id);
    this.listener.edit(added.text);
  }

  /** Put a pause [s] before the selected word, or the one at the slider; false outside of speeches. */
  pause(duration: number): boolean {
    const isPlanned = !this.listener.isGesture() && this.plan.isCurrent;
    const word = isPlanned ? this.listener.wordAt(this.listener.time()) : undefined;
    const paused = word ? pauseBefore(this.listener.text(), word, duration) : null;
    if (paused !== null) this.listener.edit(paused);
    else this.listener.say("the pause is a wait: it delays only what refers to its end");
    return paused !== null;
  }
}
