// Keys of a gesture as a table: one key at a time, with position, palm and shape of each hand.
import { byId, make } from "./dom.ts";
import type { GestureDraft, HandKey } from "./types.ts";

const FIELDS = ["palm", "pointing", "shape", "touch"] as const;
const TITLES: Record<string, string> = {
  "Capture pose": "Set the hands to their positions on the stage, of a robot posed by hand or of a dragged posture",
};
const AXES = ["out", "up", "forward"] as const;

export interface KeysListener {
  choose(key: number): void;
  set(key: number, hand: string, name: string, value: string | null): void;
  copy(key: number): void;
  remove(key: number): void;
  mirror(): void;
  capture(): void;
}

export class KeysPanel {
  chosen = 0;
  private readonly place = byId("keys");

  constructor(private readonly listener: KeysListener) {}

  show(draft: GestureDraft): void {
    this.chosen = Math.min(this.chosen, draft.keys.length - 1);
    const tabs = draft.keys.map((_, k) => {
      const tab = make("button", { type: "button", "aria-pressed": String(k === this.chosen) }, `Pose ${k + 1}`);
      tab.addEventListener("click", () => this.listener.choose(k));
      return tab;
    });
    const hands = Object.entries(draft.keys[this.chosen] ?? {}).filter(([, hand]) => Array.isArray(hand?.at));
    const acts: [string, () => void][] = [
      ["Copy pose", () => this.listener.copy(this.chosen)],
      ["Remove pose", () => this.listener.remove(this.chosen)],
      ["Mirror", () => this.listener.mirror()],
      ["Capture pose", () => this.listener.capture()],
    ];
    this.place.replaceChildren(
      make("div", { class: "group", role: "group", "aria-label": "Key poses" }, ...tabs),
      ...hands.map(([name, hand]) => this.hand(name, hand)),
      make("div", { class: "acts" }, ...acts.map(([words, act]) => this.button(words, act))),
      make("ul", { "aria-label": "Checks" }, ...draft.checks.map((each) => this.check(each))),
    );
  }

  private button(words: string, act: () => void): HTMLElement {
    const made = make("button", { type: "button", title: TITLES[words] ?? "" }, words);
    made.addEventListener("click", act);
    return made;
  }

  private check({ name, ok, text }: GestureDraft["checks"][number]): HTMLElement {
    return make("li", { class: ok ? "good" : "bad", title: `Check of the ${name}` }, text);
  }

  private hand(name: string, hand: HandKey): HTMLElement {
    const inputs = AXES.map((axis, k) =>
      make("input", {
        value: String(hand.at[k] ?? 0),
        "aria-label": `${name} ${axis}`,
        title: `${axis} in arm lengths, or the name of a zone`,
      }),
    );
    for (const input of inputs)
      input.addEventListener("change", () => {
        const all = inputs.map(({ value }) =>
          Number.isFinite(Number(value)) && value !== "" ? value : JSON.stringify(value),
        );
        this.listener.set(this.chosen, name, "at", `[${all.join(", ")}]`);
      });
    const places = AXES.map((axis, k) => make("label", {}, axis, inputs[k]!));
    const fields = FIELDS.map((field) => {
      const made = make("input", { value: String(hand[field] ?? ""), "aria-label": `${name} ${field}` });
      made.addEventListener("change", () =>
        this.listener.set(this.chosen, name, field, made.value.trim() ? JSON.stringify(made.value.trim()) : null),
      );
      return make("label", { class: "field" }, field, made);
    });
    return make(
      "fieldset",
      {},
      make("legend", {}, name === "both" ? "both hands" : `${name} hand`),
      make("div", { class: "place" }, ...places),
      ...fields,
    );
  }
}
