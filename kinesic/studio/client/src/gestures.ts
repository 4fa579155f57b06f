// The gestures of the lexicon, found by what they are called, what they mean and their category.
import { byId, make } from "./dom.ts";
import type { About } from "./types.ts";

const SHOWN = 25;

export class GestureList {
  private readonly search = byId<HTMLInputElement>("search");
  private readonly list = byId("found");

  constructor(
    private gestures: About["gestures"],
    private readonly listener: { insert(id: string): void; edit(id: string): void },
  ) {
    this.search.addEventListener("input", () => this.show());
    this.show();
  }

  /** Lists a gesture before all others. */
  add(gesture: About["gestures"][number]): void {
    this.gestures = [gesture, ...this.gestures.filter(({ id }) => id !== gesture.id)];
    this.show();
  }

  private show(): void {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.gestures.filter(({ id, category, says }) =>
      words.every((word) => `${id} ${category} ${says}`.toLowerCase().includes(word)),
    );
    this.list.replaceChildren(...found.slice(0, SHOWN).map((each) => this.row(each)));
    byId("count").textContent = found.length > SHOWN ? `${found.length}, the first ${SHOWN} shown` : `${found.length}`;
  }

  private row({ id, category, says }: About["gestures"][number]): HTMLElement {
    const act = (words: string, label: string, does: () => void) => {
      const made = make("button", { type: "button", "aria-label": label }, words);
      made.addEventListener("click", does);
      return made;
    };
    return make(
      "li",
      { class: "gesture" },
      make("span", { title: says }, make("b", {}, id), ` ${category}`),
      act("Add", `Add ${id} to the document`, () => this.listener.insert(id)),
      act("Edit", `Edit a copy of ${id}`, () => this.listener.edit(id)),
    );
  }
}
