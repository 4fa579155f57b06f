// Messages behind the buttons of the wizard's panel.
import type { Deed } from "./session.ts";

/** Places at which the robot looks, as a person's eyes [m]: forward, left, up. */
export const PLACES: Readonly<Record<string, readonly [number, number, number]>> = {
  "left person": [1.2, 0.8, 1.5],
  "person ahead": [1.5, 0, 1.5],
  "right person": [1.2, -0.8, 1.5],
};
export const FILLERS = ["Hm.", "Well,", "Let me think."] as const;
export const PERSON = "wizard"; // id of the person whom the wizard reports

export const converse = (on: boolean): Deed => ({ do: "converse", values: { on } });
export const listen = (on: boolean): Deed => ({ do: "heard", values: { voice: on, who: PERSON } });
export const think = (on: boolean): Deed => ({ do: "think", values: { on } });
export const yieldTurn = (): Deed => ({ do: "interrupt", values: { yield: true } });
export const say = (text: string): Deed => ({ do: "words", values: { text, ends: true } });

/** Return the report of a person at a place; repeated reports keep the person there. */
export const lookAt = (at: readonly [number, number, number]): Deed => ({
  do: "people",
  values: { people: [{ id: PERSON, at, looks: true }] },
});

/** Return a nod; the number makes the id of its block unique. */
export const nod = (number: number): Deed => ({
  do: "bml",
  values: { bml: `<bml id="wizard${number}"><head id="h" lexeme="NOD" start="0"/></bml>` },
});

/** Return the non-empty lines of a text. */
export const linesOf = (text: string): string[] =>
  text
    .split("\n")
    .map((line) => line.trim())
    .filter(Boolean);
