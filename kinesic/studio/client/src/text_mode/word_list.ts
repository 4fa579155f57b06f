// Spoken words as buttons, each with its gestures; arrow keys move from word to word.
import { byId, make } from "../dom.ts";
import { gestureWords, isBeat } from "../plain_words.ts";
import { describeGesture, type ShownGesture, type SpokenWord } from "./spoken.ts";

export class WordList {
  private readonly place = byId("spoken");

  constructor(private readonly choose: (index: number) => void) {
    this.place.addEventListener("keydown", (event) => this.step(event));
  }

  /** Show words with the chosen one (-1: none), and mark picked gestures if `marksPicked`; the focus stays. */
  show(words: readonly SpokenWord[], chosen: number, marksPicked: boolean): void {
    const isFocused = this.place.contains(document.activeElement);
    const isMarked = ({ isPicked }: ShownGesture) => isPicked && marksPicked;
    const buttons = words.map((word, index) => {
      const button = make(
        "button",
        {
          type: "button",
          "data-spoken": String(index),
          "aria-pressed": String(index === chosen),
          tabindex: index === Math.max(chosen, 0) ? "0" : "-1",
          title: word.gestures.map((each) => describeGesture(each, isMarked(each))).join("\n") || "no gesture",
        },
        word.text,
        ...word.gestures.map((each) => drawGesture(each, isMarked(each))),
      );
      button.addEventListener("click", () => this.choose(index));
      return button;
    });
    this.place.replaceChildren(...buttons);
    if (isFocused) buttons[Math.max(chosen, 0)]?.focus();
  }

  /** Show whether a word is chosen. */
  press(index: number, isChosen: boolean): void {
    this.button(index)?.setAttribute("aria-pressed", String(isChosen));
  }

  private button(index: number): HTMLElement | null {
    return this.place.querySelector(`[data-spoken="${index}"]`);
  }

  private step(event: KeyboardEvent): void {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const focused = event.target as HTMLElement;
    const next = by === undefined ? null : this.button(Number(focused.dataset.spoken) + by);
    if (!next) return;
    event.preventDefault();
    focused.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  }
}

/** Return the mark of a gesture below its word; all beats look alike, as a person seldom cares which one it is. */
function drawGesture({ name }: ShownGesture, isMarked: boolean): HTMLElement {
  const kind = `shown${isMarked ? " picked" : ""}${isBeat(name) ? " beat" : ""}`;
  return make("span", { class: kind }, isBeat(name) ? "beat" : gestureWords(name));
}
