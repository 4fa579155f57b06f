// Text pane of the document with line numbers and the position of an error.
import { byId, make } from "./dom.ts";
import type { Fault } from "./types.ts";
import { tagWithId } from "./xml.ts";

const MAX_NUMBERED_LINES = 10_000; // largest number of numbered lines

export class TextPane {
  private readonly area = byId<HTMLTextAreaElement>("text");
  private readonly gutter = byId("gutter");
  private fault: Fault | null = null;

  constructor(changed: (text: string) => void) {
    this.area.addEventListener("input", () => {
      this.number();
      changed(this.area.value);
    });
    this.area.addEventListener("scroll", () => {
      this.gutter.scrollTop = this.area.scrollTop;
    });
  }

  show(text: string): void {
    const { scrollTop } = this.area;
    this.area.value = text;
    this.area.scrollTop = scrollTop;
    this.number();
  }

  /** Show the position of an error; null: no error. */
  mark(fault: Fault | null): void {
    this.fault = fault;
    this.area.setAttribute("aria-invalid", String(fault !== null));
    byId("fault").textContent = fault ? `${fault.line}:${fault.column} ${fault.text}` : "";
    byId("fault").hidden = fault === null;
    this.number();
  }

  /** Scroll to a behaviour. */
  find(behaviour: string): void {
    const tag = tagWithId(this.area.value, behaviour);
    if (!tag) return;
    const line = this.area.value.slice(0, tag.from).split("\n").length;
    this.area.setSelectionRange(tag.from, tag.to);
    this.area.scrollTop = (line - 4) * Number.parseFloat(getComputedStyle(this.area).lineHeight);
  }

  private number(): void {
    const count = Math.min(this.area.value.split("\n").length, MAX_NUMBERED_LINES);
    while (this.gutter.children.length > count) this.gutter.lastElementChild?.remove();
    while (this.gutter.children.length < count)
      this.gutter.append(make("li", {}, String(this.gutter.children.length + 1)));
    this.gutter.querySelector(".wrong")?.classList.remove("wrong");
    if (this.fault) this.gutter.children[this.fault.line - 1]?.classList.add("wrong");
    this.gutter.scrollTop = this.area.scrollTop;
  }
}
