// Sliders for the manner of the selected behaviour; each number is set in the document or left to the style.
import { byId, make } from "./dom.ts";

const EXPRESSIVITY_RANGES: Record<string, number> = {
  spatial: -1,
  temporal: -1,
  fluidity: -1,
  power: -1,
  tension: -1,
  repetition: -1,
  activation: -1,
  openness: 0,
};
const AS_STYLE = "as style";

export class Manners {
  private readonly sliders = new Map<string, { slider: HTMLInputElement; shown: HTMLOutputElement }>();

  constructor(changed: (name: string, value: number | null) => void) {
    for (const [name, least] of Object.entries(EXPRESSIVITY_RANGES)) {
      const slider = make("input", { type: "range", min: String(least), max: "1", step: "0.05", "aria-label": name });
      const shown = make("output");
      slider.title = "Double-click for the value of the style";
      slider.addEventListener("input", () => this.say(name, slider.value));
      slider.addEventListener("change", () => changed(name, Number(slider.value)));
      slider.addEventListener("dblclick", () => changed(name, null));
      byId("manners").append(make("label", { class: "manner" }, name, slider, shown));
      this.sliders.set(name, { slider, shown });
    }
  }

  /** Show the values in the document; undefined: left to the style. */
  show(read: (name: string) => string | undefined): void {
    for (const [name, { slider }] of this.sliders) {
      const value = read(name);
      slider.value = value ?? "0";
      this.say(name, value);
    }
  }

  private say(name: string, value: string | undefined): void {
    const shown = this.sliders.get(name)?.shown;
    if (shown) shown.textContent = value === undefined ? "–" : Number(value).toFixed(2);
    if (shown) shown.title = value === undefined ? AS_STYLE : "";
  }
}
