// Tabs of the document pane: words or source; the last choice is remembered.
import { byId } from "../dom.ts";

const NAMES = ["words", "source"] as const;
type Name = (typeof NAMES)[number];
const STORED_KEY = "document-tab"; // key of the chosen tab in the browser's storage

export class Tabs {
  private chosen: Name = localStorage.getItem(STORED_KEY) === "source" ? "source" : "words";
  private isGesture = false;

  constructor() {
    for (const name of NAMES) {
      const tab = byId(`tab-${name}`);
      tab.addEventListener("click", () => this.choose(name));
      tab.addEventListener("keydown", (event) => {
        if (!["ArrowLeft", "ArrowRight"].includes(event.key) || this.isGesture) return;
        event.preventDefault();
        this.choose(name === "words" ? "source" : "words");
        byId(`tab-${this.chosen}`).focus();
      });
    }
    this.show();
  }

  /** Show only the source of a gesture, which has no words. */
  limit(isGesture: boolean): void {
    this.isGesture = isGesture;
    this.show();
  }

  choose(name: Name): void {
    this.chosen = name;
    localStorage.setItem(STORED_KEY, name);
    this.show();
  }

  private show(): void {
    const shown = this.isGesture ? "source" : this.chosen;
    byId("tab-words").hidden = this.isGesture;
    for (const name of NAMES) {
      byId(`pane-${name}`).hidden = name !== shown;
      byId(`tab-${name}`).setAttribute("aria-selected", String(name === shown));
      byId(`tab-${name}`).tabIndex = name === shown ? 0 : -1;
    }
  }
}
