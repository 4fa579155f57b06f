// The eight numbers of a style, and which of them a behaviour changes.
import type { Answer } from "../wire.ts";

/** Range of each number; 0 is neutral. */
export const RANGES: Readonly<Record<string, readonly [least: number, most: number]>> = {
  spatial: [-1, 1],
  temporal: [-1, 1],
  fluidity: [-1, 1],
  power: [-1, 1],
  tension: [-1, 1],
  repetition: [-1, 1],
  activation: [-1, 1],
  openness: [0, 1],
};
export const NAMES: readonly string[] = Object.keys(RANGES);
/** Word on the slider of each number, and its technical name with the effects of low and high values. */
export const WORDS: Readonly<Record<string, readonly [word: string, explanation: string]>> = {
  spatial: ["size", "Spatial extent: from small to large gestures"],
  temporal: ["speed", "Temporal extent: from slow to fast"],
  fluidity: ["flow", "Fluidity: from abrupt to smooth"],
  power: ["force", "Power: from weak to forceful"],
  tension: ["tension", "Tension: from loose to tense"],
  repetition: ["repeats", "Repetition: from one stroke to several"],
  activation: ["energy", "Activation: from passive to animated, by size, speed, force and elbows together"],
  openness: ["elbows out", "Openness: from elbows at the body to elbows away from it"],
};
const EQUAL_NUMBERS = 0.005; // smallest difference that a slider shows

export type Numbers = Readonly<Record<string, number>>;
export const NEUTRAL: Numbers = Object.fromEntries(NAMES.map((name) => [name, 0]));

export interface Style {
  name: string;
  own: boolean;
  numbers: Numbers;
  /** Text of its file. */
  text: string;
}

/** One number as a slider shows it. */
export interface Shown {
  value: number;
  /** Value without the behaviour's own attribute. */
  inherited: number;
  /** Whether the behaviour sets it. */
  isSet: boolean;
  /** Whether it differs from neutral. */
  differs: boolean;
}

export const areEqual = (a: number, b: number): boolean => Math.abs(a - b) < EQUAL_NUMBERS;

/** Read the styles of a server's answer; empty for any other answer. */
export function readStyles(answer: Answer | null): Style[] {
  if (answer?.told !== "styles" || !Array.isArray(answer.styles)) return [];
  return (answer.styles as Style[]).filter(
    ({ name, numbers, text }) =>
      typeof name === "string" &&
      typeof text === "string" &&
      typeof numbers === "object" &&
      NAMES.every((each) => Number.isFinite(numbers[each])),
  );
}

/** Return all numbers of a behaviour: its attributes over the inherited ones. */
export function showNumbers(read: (name: string) => string | undefined, inherited: Numbers): Record<string, Shown> {
  return Object.fromEntries(
    NAMES.map((name) => {
      const written = read(name);
      const [own, other] = [Number(written), inherited[name] ?? 0];
      const isSet = written !== undefined && written.trim() !== "" && Number.isFinite(own);
      const value = isSet ? own : other;
      return [name, { value, inherited: other, isSet, differs: !areEqual(value, 0) }];
    }),
  );
}

/** Return the attributes that give a behaviour some numbers; null removes one that equals the inherited number. */
export const changesFor = (numbers: Numbers, inherited: Numbers): [name: string, value: number | null][] =>
  NAMES.map((name) => [name, areEqual(numbers[name]!, inherited[name] ?? 0) ? null : numbers[name]!]);

/** Replace the eight numbers in the text of a style file; its other lines stay. */
export function withNumbers(text: string, numbers: Numbers): string {
  const end = text.search(/^\s*\[/m); // of the keys before the first table
  const [head, tables] = end < 0 ? [text, ""] : [text.slice(0, end), text.slice(end)];
  const lines = NAMES.reduce((present, name) => {
    const line = new RegExp(`^(\\s*${name}\\s*=\\s*)[-+.\\w]+`, "m");
    const value = String(Math.round(numbers[name]! * 1000) / 1000);
    return line.test(present) ? present.replace(line, `$1${value}`) : `${present}${name} = ${value}\n`;
  }, head);
  return lines + tables;
}
