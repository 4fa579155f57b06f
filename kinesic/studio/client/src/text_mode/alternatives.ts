// List of the gestures that could be shown at a word, the best first, with their reasons.
import { byId, make, say } from "../dom.ts";
import { categoryWords, gestureWords, isBeat } from "../plain_words.ts";
import type { Answer } from "../wire.ts";
import type { Choice } from "./replacing.ts";
import type { ShownGesture } from "./spoken.ts";

export interface Alternative extends Choice {
  category: string;
  says: string;
  /** What the robot lacks for the gesture; empty or missing: nothing. */
  lacks?: string;
}

const SCORE = / \([\d.]+\)$/; // how well a gesture fits; the order of the list shows it

/** Read the alternatives of a server's answer; empty for any other answer. */
export function readAlternatives(answer: Answer | null): Alternative[] {
  if (answer?.told !== "alternatives" || !Array.isArray(answer.gestures)) return [];
  return (answer.gestures as Alternative[])
    .filter(({ id, why }) => typeof id === "string" && typeof why === "string")
    .map((each) => ({ ...each, why: each.why.replace(SCORE, "") }));
}

export class AlternativesPanel {
  private readonly place = byId("alternatives");

  constructor(
    private readonly listener: {
      choose(choice: Choice): void;
      remove(): void;
      /** Picture of a gesture; null if there is none. */
      picture(gesture: string): Element | null;
    },
  ) {
    byId("alternatives-remove").addEventListener("click", () => this.listener.remove());
  }

  hide(): void {
    this.place.hidden = true;
  }

  /** Show the present gesture of a word, with reasons, and what else could be shown; null: still asked for. */
  show(
    word: string,
    present: ShownGesture | null,
    alternatives: readonly Alternative[] | null,
    reasons: readonly string[] = [],
  ): void {
    this.place.hidden = false;
    say(byId("alternatives-title"), present ? `“${word}”: ${gestureWords(present.name)}` : `“${word}”: no gesture`);
    say(
      byId("alternatives-reason"),
      present ? present.reason || "the document gives no reason" : "Choose one below, or Add one from Gestures.",
    );
    say(byId("alternatives-choice"), reasons.filter(Boolean).join(" "));
    byId("alternatives-remove").hidden = present === null;
    const none = alternatives ? "nothing fits this word" : "looking for gestures …";
    const rows = alternatives?.length ? this.rows(alternatives, present?.name) : [make("li", { class: "none" }, none)];
    byId("alternatives-list").replaceChildren(...rows);
  }

  /** Return the rows of alternatives; beats, which fit every word, are folded after all others. */
  private rows(alternatives: readonly Alternative[], present: string | undefined): HTMLElement[] {
    const draw = (each: Alternative) => this.row(each, each.id === present);
    const [beats, others] = [alternatives.filter(({ id }) => isBeat(id)), alternatives.filter(({ id }) => !isBeat(id))];
    if (!beats.length || !others.length) return alternatives.map(draw);
    const folded = make(
      "details",
      {},
      make("summary", {}, describeBeats(beats.length)),
      make("ul", {}, ...beats.map(draw)),
    );
    folded.open = beats.some(({ id }) => id === present);
    return [...others.map(draw), make("li", {}, folded)];
  }

  /** Mark a chosen gesture until its plan arrives; null: the gesture is removed. */
  markChosen(word: string, gesture: string | null): void {
    say(
      byId("alternatives-title"),
      `“${word}”: ${gesture === null ? "no gesture" : gestureWords(gesture)}, planning …`,
    );
    for (const place of ["alternatives-reason", "alternatives-choice"]) say(byId(place), "");
    for (const button of byId("alternatives-list").querySelectorAll<HTMLElement>("[data-gesture]"))
      button.setAttribute("aria-pressed", String(button.dataset.gesture === gesture));
  }

  /** Scroll as much of the list into view as the pane has room for, and its title in any case. */
  reveal(): void {
    this.place.scrollIntoView({ block: "nearest" });
    byId("alternatives-title").scrollIntoView({ block: "nearest" });
  }

  private row(each: Alternative, isPresent: boolean): HTMLElement {
    const button = make(
      "button",
      { type: "button", "aria-pressed": String(isPresent), title: each.says, "data-gesture": each.id },
      this.listener.picture(each.id) ?? make("span"),
      make(
        "span",
        {},
        make("b", {}, gestureWords(each.id)),
        ` ${categoryWords(each.category)}`,
        make("span", { class: "why" }, [each.why, each.lacks].filter(Boolean).join("; ")),
      ),
    );
    button.addEventListener("click", () => this.listener.choose(each));
    return make("li", {}, button);
  }
}

const describeBeats = (count: number): string =>
  count === 1 ? "1 small movement that stresses the word" : `${count} small movements that stress the word`;
