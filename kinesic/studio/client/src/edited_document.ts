// Text of the open document, with undo and redo.
import { begin, change, type History, redo, undo } from "./history.ts";

export class EditedDocument {
  private history: History<string> = begin("");

  /** `changed` is called after each change; `isTyped`: the change was typed into the text pane. */
  constructor(private readonly changed: (isTyped: boolean) => void) {}

  get text(): string {
    return this.history.present;
  }

  /** Number of changes that can be undone. */
  get undoSteps(): number {
    return this.history.past.length;
  }

  /** Number of undone changes that can be made again. */
  get redoSteps(): number {
    return this.history.future.length;
  }

  /** Replace the document by another one, which has no changes yet. */
  begin(text: string): void {
    this.history = begin(text);
  }

  edit(text: string, isTyped = false): void {
    this.step(change(this.history, text), isTyped);
  }

  undo(): void {
    this.step(undo(this.history), false);
  }

  redo(): void {
    this.step(redo(this.history), false);
  }

  private step(history: History<string>, isTyped: boolean): void {
    if (history === this.history) return;
    this.history = history;
    this.changed(isTyped);
  }
}
