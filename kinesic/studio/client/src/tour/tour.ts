// Tour of the page: a note beside one part after the other; that it was seen is remembered.
import { byId, say } from "../dom.ts";
import { STEPS } from "./steps.ts";

const SEEN_KEY = "tour-seen"; // key in the browser's storage
const GAP = 10; // [CSS pixels] between a part and its note

export class Tour {
  private readonly note = byId("tour");
  private readonly opener = byId("tour-start");
  private at = -1; // index of the shown step; -1: none

  /** `showWords` shows the tab that two of the steps explain. */
  constructor(private readonly showWords: () => void) {
    this.opener.addEventListener("click", () => (this.at < 0 ? this.show(0) : this.end()));
    byId("tour-next").addEventListener("click", () => this.show(this.at + 1));
    byId("tour-back").addEventListener("click", () => this.show(this.at - 1));
    byId("tour-skip").addEventListener("click", () => this.end());
    this.note.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.end();
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (by === undefined || this.at + by < 0) return;
      event.preventDefault();
      this.show(this.at + by);
    });
    window.addEventListener("resize", () => this.place());
    this.label();
  }

  private show(index: number): void {
    this.part?.removeAttribute("data-tour");
    const step = STEPS[index];
    if (!step) {
      this.end();
      return;
    }
    if (this.at < 0) this.showWords();
    this.at = index;
    say(byId("tour-title"), step.title);
    say(byId("tour-text"), step.text);
    say(byId("tour-count"), `Step ${index + 1} of ${STEPS.length}`);
    say(byId("tour-next"), index + 1 < STEPS.length ? "Next" : "Done");
    byId<HTMLButtonElement>("tour-back").disabled = index === 0;
    this.note.hidden = false;
    this.part?.setAttribute("data-tour", "");
    this.part?.scrollIntoView({ block: "nearest" });
    this.place();
    byId("tour-next").focus();
  }

  private end(): void {
    this.part?.removeAttribute("data-tour");
    this.at = -1;
    this.note.hidden = true;
    localStorage.setItem(SEEN_KEY, "yes");
    this.label();
    this.opener.focus();
  }

  private label(): void {
    const isSeen = localStorage.getItem(SEEN_KEY) !== null;
    say(this.opener, isSeen ? "Tour" : "Take the tour");
    this.opener.classList.toggle("primary", !isSeen);
  }

  private get part(): HTMLElement | null {
    const step = STEPS[this.at];
    return step ? document.querySelector<HTMLElement>(step.part) : null;
  }

  /** Place the note beside its part, within the window. */
  private place(): void {
    const { part } = this;
    if (!part) return;
    const [area, note] = [part.getBoundingClientRect(), this.note.getBoundingClientRect()];
    const control = byId("control");
    const bar = getComputedStyle(control).position === "fixed" ? control.getBoundingClientRect().height : 0;
    const [width, height] = [document.documentElement.clientWidth, window.innerHeight - bar]; // Stop stays visible
    const below = area.bottom + GAP;
    const above = area.top - GAP - note.height;
    const inside = area.top + area.height / 2 - note.height / 2;
    const top = below + note.height <= height - GAP ? below : above >= GAP ? above : inside;
    const left = area.left + area.width / 2 - note.width / 2;
    this.note.style.top = `${clamp(top, height - note.height - GAP)}px`;
    this.note.style.left = `${clamp(left, width - note.width - GAP)}px`;
  }
}

const clamp = (value: number, most: number): number => Math.max(GAP, Math.min(value, most));
