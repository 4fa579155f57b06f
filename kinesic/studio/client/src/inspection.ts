// The selected behaviours, or the whole performance, in the inspector. Changes go into the document, or into the
// expressivity that is tried on a gesture under edit.
import { setAttribute, setKinesicAttribute } from "./edits.ts";
import { Inspector } from "./inspector.ts";
import { outcomeWords } from "./plain_words.ts";
import type { Numbers } from "./styles/numbers.ts";
import type { StylesPanel } from "./styles/styles_panel.ts";
import type { Draft } from "./types.ts";
import { BLOCK, findAttribute, tagWithId } from "./xml.ts";

/** Parts of the page that the inspection needs. */
export interface InspectionListener {
  text(): string;
  edit(text: string): void;
  draft(): Draft | null;
  /** Ids of the selected behaviours, or of the gesture under edit. */
  selected(): readonly string[];
  isGesture(): boolean;
  /** Expressivity that is tried on the gesture under edit. */
  tried(): Map<string, number>;
  /** Plan the gesture under edit again, with other expressivity. */
  tryAgain(): void;
}

export class Inspection {
  private readonly inspector: Inspector;

  constructor(
    private readonly styles: () => StylesPanel,
    private readonly listener: InspectionListener,
  ) {
    this.inspector = new Inspector({
      attribute: (name, value) => this.edit((text, id) => changeAttribute(text, id, name, value)),
      expressivity: (name, value) => {
        this.styles().preview.expect();
        if (listener.isGesture()) this.tryExpressivity(name, value);
        else this.edit((text, id) => setKinesicAttribute(text, id, name, value));
      },
      style: (name) => this.edit((text, id) => this.styles().choose(text, id, name)),
    });
  }

  /** Numbers that the sliders show now. */
  get numbers(): Numbers {
    return this.inspector.sliders.numbers;
  }

  /** Show the selected behaviours, or else the whole performance. */
  show(): void {
    const draft = this.listener.draft();
    const ids = this.ids;
    const first = ids[0]!;
    const behaviour = draft?.behaviours.find(({ id }) => id === first);
    const type = first === BLOCK ? "block" : behaviour?.type;
    const warning = behaviour && ids.length === 1 ? outcomeWords(behaviour) : "";
    const alone = this.listener.isGesture();
    const inherited = this.styles().inherited(this.listener.text(), first);
    const read = (name: string) => this.read(first, name);
    this.inspector.show(draft && type ? { ids, type, warning, read, inherited, alone } : null);
  }

  /** Ids of all behaviours that a change concerns; `BLOCK` stands for the whole performance. */
  get ids(): readonly string[] {
    const selected = this.listener.selected();
    return selected.length ? selected : [BLOCK];
  }

  private read(id: string, name: string): string | undefined {
    if (this.listener.isGesture()) return this.listener.tried().get(name)?.toString();
    const tag = tagWithId(this.listener.text(), id);
    return tag && findAttribute(tag, name)?.value;
  }

  private edit(change: (text: string, id: string) => string): void {
    this.listener.edit(this.ids.reduce(change, this.listener.text()));
  }

  private tryExpressivity(name: string, value: number | null): void {
    if (value === null) this.listener.tried().delete(name);
    else this.listener.tried().set(name, value);
    this.listener.tryAgain();
  }
}

/** Set an attribute; another gesture loses the reason that the server gave for the former one. */
function changeAttribute(text: string, id: string, name: string, value: string | null): string {
  const changed = setAttribute(text, id, name, value);
  return name === "lexeme" ? setKinesicAttribute(changed, id, "reason", null) : changed;
}
