// Editable attributes of the selected behaviour.
import { byId, say } from "./dom.ts";
import { ExpressivitySliders } from "./expressivity_sliders.ts";
import { gestureId, gestureWords, labelWords, typeWords } from "./plain_words.ts";
import type { Numbers } from "./styles/numbers.ts";
import { BLOCK } from "./xml.ts";

const ATTRIBUTES = ["lexeme", "mode"] as const;

export interface Chosen {
  /** One behaviour, several, or `BLOCK` for the whole performance. */
  ids: readonly string[];
  /** Type of the first one. */
  type: string;
  /** Difference of a single behaviour from the request, with its reason; empty without one. */
  warning: string;
  /** Value in the document, or undefined. */
  read(name: string): string | undefined;
  /** Numbers of its style. */
  inherited: Numbers;
  /** Whether it is a gesture under edit, where only the expressivity can be changed. */
  alone: boolean;
}

export class Inspector {
  readonly sliders: ExpressivitySliders;
  private readonly style = byId<HTMLSelectElement>("own-style");

  constructor(listener: {
    attribute(name: string, value: string | null): void;
    expressivity(name: string, value: number | null): void;
    style(name: string | null): void;
  }) {
    this.sliders = new ExpressivitySliders((name, value) => listener.expressivity(name, value));
    this.style.addEventListener("change", () => listener.style(this.style.value || null));
    for (const name of ATTRIBUTES)
      byId(name).addEventListener("change", () => listener.attribute(name, readField(name) || null));
  }

  show(chosen: Chosen | null): void {
    byId("inspector").hidden = !chosen;
    if (!chosen) return;
    const isBlock = chosen.ids[0] === BLOCK;
    const isSingle = chosen.ids.length === 1;
    say(byId("chosen"), describe(chosen));
    say(byId("chosen-warning"), chosen.warning);
    byId("remove").hidden = chosen.alone || isBlock;
    byId("lexeme-line").hidden = byId("hand-line").hidden = chosen.type !== "gesture" || chosen.alone || !isSingle;
    byId("usual-style").hidden = !isBlock;
    byId("whole-line").hidden = isBlock || chosen.alone;
    say(
      byId("style-scope"),
      isBlock ? "Style" : isSingle ? `Style of this ${typeWords(chosen.type)} only` : "Style of these only",
    );
    say(byId("no-own-style"), isBlock ? "usual style" : "as the performance");
    byId("manners").hidden = chosen.type === "speech";
    byId<HTMLInputElement>("lexeme").value = gestureWords(chosen.read("lexeme") ?? "");
    byId<HTMLSelectElement>("mode").value = chosen.read("mode") ?? "";
    byId("style-line").hidden = chosen.alone;
    this.style.value = chosen.read("style") ?? "";
    this.sliders.show((name) => chosen.read(name), chosen.inherited);
  }
}

/** Return what the shown style is the style of. */
function describe({ ids, type, read, alone }: Chosen): string {
  if (alone) return "This gesture";
  if (ids.length > 1) return `${ids.length} selected`;
  return ids[0] === BLOCK ? "Whole performance" : `${typeWords(type)} ${labelWords(type, read("lexeme") ?? ids[0]!)}`;
}

/** Return the value of a field; a gesture that is named in words gets its id. */
function readField(name: (typeof ATTRIBUTES)[number]): string {
  const value = byId<HTMLInputElement>(name).value.trim();
  return name === "lexeme" ? gestureId(value) : value;
}
