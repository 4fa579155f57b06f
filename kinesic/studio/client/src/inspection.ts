// The selected behaviour in the inspector; changes go into the document, or into the tried manner of a gesture.
import { setAttribute, setManner } from "./edits.ts";
import { Inspector } from "./inspector.ts";
import type { Numbers } from "./styles/numbers.ts";
import type { StylesPanel } from "./styles/styles_panel.ts";
import type { Draft } from "./types.ts";
import { BLOCK, findAttribute, tagWithId } from "./xml.ts";

/** Parts of the page that the inspection needs. */
export interface InspectionListener {
  text(): string;
  edit(text: string): void;
  draft(): Draft | null;
  /** Id of the only selected behaviour, or of the gesture under edit. */
  chosen(): string | null;
  isGesture(): boolean;
  /** Manner that is tried on the gesture under edit. */
  tried(): Map<string, number>;
  /** Plan the gesture under edit again, with another manner. */
  tryAgain(): void;
}

export class Inspection {
  private readonly inspector: Inspector;

  constructor(
    private readonly styles: () => StylesPanel,
    private readonly listener: InspectionListener,
  ) {
    this.inspector = new Inspector({
      attribute: (name, value) => this.edit((text, chosen) => setAttribute(text, chosen, name, value)),
      manner: (name, value) => {
        this.styles().preview.expect();
        if (listener.isGesture()) this.tryManner(name, value);
        else this.edit((text, chosen) => setManner(text, chosen, name, value));
      },
      style: (name) => this.edit((text, chosen) => this.styles().choose(text, chosen, name)),
    });
  }

  /** Numbers that the sliders show now. */
  get numbers(): Numbers {
    return this.inspector.manners.numbers;
  }

  /** Show the selected behaviour, or nothing. */
  show(): void {
    const chosen = this.listener.chosen();
    const draft = this.listener.draft();
    const block = chosen === BLOCK && draft ? { id: BLOCK, type: "block" } : null;
    const shown = draft?.behaviours.find(({ id }) => id === chosen) ?? block;
    const inherited = this.styles().inherited(this.listener.text(), shown?.id ?? "");
    const alone = this.listener.isGesture();
    const read = (name: string) => this.read(shown?.id ?? "", name);
    this.inspector.show(shown ? { id: shown.id, type: shown.type, read, inherited, alone } : null);
  }

  private read(id: string, name: string): string | undefined {
    if (this.listener.isGesture()) return this.listener.tried().get(name)?.toString();
    const tag = tagWithId(this.listener.text(), id);
    return tag && findAttribute(tag, name)?.value;
  }

  private edit(change: (text: string, chosen: string) => string): void {
    const chosen = this.listener.chosen();
    if (chosen) this.listener.edit(change(this.listener.text(), chosen));
  }

  private tryManner(name: string, value: number | null): void {
    if (value === null) this.listener.tried().delete(name);
    else this.listener.tried().set(name, value);
    this.listener.tryAgain();
  }
}
