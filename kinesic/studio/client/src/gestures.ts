// List of the lexicon's gestures with a search; the server ranks them, as `kinesic gestures find` does.
import { byId, make } from "./dom.ts";
import { categoryWords, gestureWords } from "./plain_words.ts";
import type { About } from "./types.ts";
import type { Answer } from "./wire.ts";

const SHOWN = 25;

type Found = About["gestures"][number] & { near?: boolean };

/** Read the gestures of a server's answer to a search; null for any other answer. */
export function readFound(answer: Answer | null): Found[] | null {
  if (answer?.told !== "find" || !Array.isArray(answer.gestures)) return null;
  return (answer.gestures as Found[]).filter(({ id }) => typeof id === "string");
}

export class GestureList {
  private readonly search = byId<HTMLInputElement>("search");
  private readonly list = byId("found");
  private readonly saved = new Set<string>(); // ids of gestures that were saved in this session

  constructor(
    private gestures: About["gestures"],
    private readonly listener: {
      insert(id: string): void;
      edit(id: string): void;
      /** Ranked gestures for some words; null without a server. */
      find(words: string): Promise<Found[] | null>;
      /** Picture of a gesture; null if there is none. */
      picture(id: string): Element | null;
    },
  ) {
    this.search.addEventListener("input", () => this.show());
    this.show();
  }

  /** Insert a gesture at the top of the list. */
  add(gesture: About["gestures"][number]): void {
    this.saved.add(gesture.id);
    this.gestures = [gesture, ...this.gestures.filter(({ id }) => id !== gesture.id)];
    this.show();
  }

  /** Draw the list again, with pictures that have been loaded. */
  redraw(): void {
    this.show();
  }

  /** Show what the page itself finds at once, and what the server finds when it answers. */
  private show(): void {
    const query = this.search.value.trim();
    const words = query.toLowerCase().split(/\s+/).filter(Boolean);
    const here = this.gestures.filter(({ id, category, says }) =>
      words.every((word) =>
        `${id} ${gestureWords(id)} ${category} ${categoryWords(category)} ${says}`.toLowerCase().includes(word),
      ),
    );
    this.showAll(here);
    if (query) void this.rank(query, here);
  }

  private async rank(query: string, here: About["gestures"]): Promise<void> {
    const found = await this.listener.find(query);
    if (found === null || this.search.value.trim() !== query) return;
    const ranked = new Set(found.map(({ id }) => id));
    const unranked = here.filter(({ id }) => !ranked.has(id) && this.saved.has(id)); // saved here, not read there yet
    this.showAll([...unranked, ...found]);
  }

  private showAll(found: Found[]): void {
    this.list.replaceChildren(...found.slice(0, SHOWN).map((each) => this.row(each)));
    byId("count").textContent = found.length > SHOWN ? `${found.length}, the first ${SHOWN} shown` : `${found.length}`;
  }

  private row({ id, category, says, near }: Found): HTMLElement {
    const act = (words: string, label: string, does: () => void) => {
      const made = make("button", { type: "button", "aria-label": label }, words);
      made.addEventListener("click", does);
      return made;
    };
    return make(
      "li",
      {
        class: near ? "gesture near" : "gesture",
        "data-add": `gesture:${id}`,
        "data-label": gestureWords(id),
        "data-gesture": id,
      },
      this.listener.picture(id) ?? make("span"),
      make("span", { title: `${says}\n${id}` }, make("b", {}, gestureWords(id)), ` ${categoryWords(category)}`),
      act("Add", `Add ${gestureWords(id)} to the document`, () => this.listener.insert(id)),
      act("Edit", `Edit a copy of ${gestureWords(id)}`, () => this.listener.edit(id)),
    );
  }
}
