// Sliders for the expressivity of the selected behaviour; each number is set in the document or left to the style.
import { byId, make } from "./dom.ts";
import { NAMES, NEUTRAL, type Numbers, RANGES, type Shown, showNumbers, WORDS } from "./styles/numbers.ts";

interface Row {
  line: HTMLElement;
  slider: HTMLInputElement;
  output: HTMLOutputElement;
  reset: HTMLButtonElement;
}

export class ExpressivitySliders {
  private readonly rows = new Map<string, Row>();
  private shown: Record<string, Shown> = {};

  constructor(changed: (name: string, value: number | null) => void) {
    for (const name of NAMES) {
      const [least, most] = RANGES[name]!;
      const [word] = WORDS[name]!;
      const slider = make("input", {
        type: "range",
        min: `${least}`,
        max: `${most}`,
        step: "0.05",
        name,
        "aria-label": word,
      });
      const output = make("output");
      const reset = make("button", { type: "button", class: "reset", "aria-label": `${word} as the style` }, "×");
      slider.addEventListener("input", () => {
        output.textContent = format(Number(slider.value));
      });
      slider.addEventListener("change", () => changed(name, Number(slider.value)));
      slider.addEventListener("dblclick", () => changed(name, null));
      reset.addEventListener("click", () => changed(name, null));
      const line = make("label", { class: "manner" }, make("span", {}, word), slider, output, reset);
      byId("sliders").append(line);
      this.rows.set(name, { line, slider, output, reset });
    }
  }

  /** Present numbers of the behaviour: its own over those of the style. */
  get numbers(): Numbers {
    return Object.fromEntries(NAMES.map((name) => [name, this.shown[name]?.value ?? 0]));
  }

  /** Show the values in the document over the inherited ones; undefined: left to the style. */
  show(read: (name: string) => string | undefined, inherited: Numbers = NEUTRAL): void {
    this.shown = showNumbers(read, inherited);
    for (const [name, { line, slider, output, reset }] of this.rows) {
      const number = this.shown[name]!;
      slider.value = String(number.value);
      output.textContent = format(number.value);
      line.classList.toggle("differs", number.differs);
      line.classList.toggle("set", number.isSet);
      reset.hidden = !number.isSet;
      const words = number.isSet ? `set here; the style has ${format(number.inherited)}` : "as the style";
      line.title = `${WORDS[name]![1]}; ${words}`;
      slider.setAttribute("aria-valuetext", `${format(number.value)}, ${words}`);
    }
  }
}

/** Format a number with its sign; neutral has none. */
const format = (value: number): string => {
  const text = Math.abs(value).toFixed(2);
  return Number(text) === 0 ? "0" : `${value < 0 ? "−" : "+"}${text}`;
};
