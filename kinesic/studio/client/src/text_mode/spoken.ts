// Spoken words of a document, each with the gestures whose strokes fall on it.
import { gestureWords, isBeat } from "../plain_words.ts";
import { listWords, type Word } from "../tracks/words.ts";
import type { Draft } from "../types.ts";
import { findAttribute, findTags, type Tag, tagWithId } from "../xml.ts";

const GESTURE_TYPES: readonly string[] = ["gesture", "pointing"];
/** Attributes that place a gesture, the most significant first. */
const PLACES = ["stroke", "strokeStart", "attackPeak", "start", "ready", "strokeEnd"] as const;
/** Begins the reason of a gesture that a person has picked or changed. */
export const PICKED_PREFIX = "chosen: ";
const REFERENCE = /^\s*([^:\s]+):([^\s+-]+)/; // speech and mark of a reference such as s:w9+0.07
const REASON = /^(.*?)(?:\s*\(([\w-]+), [\d.]+\))?$/s; // reason, with intent and score in parentheses

/** Gesture at a word, as the document has it. */
export interface ShownGesture {
  id: string;
  type: string;
  /** Lexeme, or target of a pointing gesture. */
  name: string;
  reason: string;
  /** Intent of the reason; empty without one. */
  intent: string;
  /** Whether a person has picked or changed it. */
  isPicked: boolean;
}

export interface SpokenWord extends Word {
  gestures: ShownGesture[];
}

/** Position of a word in the text of a document. */
type Place = Pick<Word, "speech" | "mark" | "index">;

/** List all spoken words with their gestures; a gesture without a mark belongs to the word at its stroke time. */
export function listSpoken(text: string, draft: Draft): SpokenWord[] {
  const words = listWords(draft).map((word) => ({ ...word, gestures: [] as ShownGesture[] }));
  for (const { id, type } of draft.behaviours) {
    if (!GESTURE_TYPES.includes(type)) continue;
    const gesture = readGesture(text, id, type);
    if (gesture) words[placeOf(text, id, draft, words)]?.gestures.push(gesture);
  }
  return words;
}

/** Add its gestures to each word of a document that is not planned yet. */
export function findShown<W extends Place>(text: string, words: readonly W[]): (W & { gestures: ShownGesture[] })[] {
  const shown = words.map((word) => ({ ...word, gestures: [] as ShownGesture[] }));
  for (const tag of findTags(text)) {
    const id = tag.closing || !GESTURE_TYPES.includes(tag.name) ? undefined : findAttribute(tag, "id")?.value;
    const gesture = id === undefined ? null : readGesture(text, id, tag.name);
    if (gesture) shown[placeInText(text, gesture.id, words)]?.gestures.push(gesture);
  }
  return shown;
}

/** Whether the server has chosen a behaviour, as its reason tells with an intent, and nobody has changed it since. */
export function isChosen(tag: Tag): boolean {
  const { reason, intent } = readReason(tag);
  return intent !== undefined && !reason.startsWith(PICKED_PREFIX);
}

function readReason(tag: Tag): { reason: string; intent: string | undefined } {
  const [, reason, intent] = REASON.exec(findAttribute(tag, "reason")?.value ?? "") ?? [];
  return { reason: reason ?? "", intent };
}

function readGesture(text: string, id: string, type: string): ShownGesture | null {
  const tag = tagWithId(text, id);
  if (!tag) return null;
  const value = (name: string) => findAttribute(tag, name)?.value ?? "";
  const { reason, intent } = readReason(tag);
  const name = type === "gesture" ? value("lexeme") : `to ${value("target")}`;
  return {
    id,
    type,
    name,
    reason: reason.replace(PICKED_PREFIX, ""),
    intent: intent ?? "",
    isPicked: !isChosen(tag),
  };
}

/** Return the index of the word to whose mark a gesture refers, or -1. */
function placeInText(text: string, id: string, words: readonly Place[]): number {
  const tag = tagWithId(text, id);
  for (const place of PLACES) {
    const [, speech, mark] = REFERENCE.exec((tag && findAttribute(tag, place)?.value) ?? "") ?? [];
    const found = words.findIndex((word) => word.speech === speech && word.mark === mark && word.index === 0);
    if (found >= 0) return found;
  }
  return -1;
}

/** Return the index of the word of a planned gesture, or -1. */
function placeOf(text: string, id: string, draft: Draft, words: readonly Word[]): number {
  const found = placeInText(text, id, words);
  const stroke = draft.syncs.find((sync) => sync.behaviour === id && sync.sync === "stroke")?.planned;
  return found >= 0 || stroke === undefined ? found : words.findLastIndex((word) => word.start <= stroke);
}

/** Return the text of a word's speech, and the position of the word in it. */
export function locate(words: readonly Word[], chosen: Word): { text: string; at: number } {
  const speech = words.filter((word) => word.speech === chosen.speech);
  const before = speech.slice(0, speech.indexOf(chosen)).map((word) => `${word.text} `);
  return { text: speech.map((word) => word.text).join(" "), at: before.join("").length };
}

/** Return the spoken text, one line for each speech. */
export function spokenText(words: readonly Word[]): string {
  const lines = new Map<string, string[]>();
  for (const { speech, text } of words) lines.set(speech, [...(lines.get(speech) ?? []), text]);
  return [...lines.values()].map((line) => line.join(" ")).join("\n");
}

/** Return name and reason of a gesture; `isMarked`: whether it says that a person has picked it. */
export function describeGesture({ name, reason }: ShownGesture, isMarked: boolean): string {
  const why = [isMarked ? "picked by you" : "", reason].filter(Boolean).join(", ");
  const words = gestureWords(name);
  return why ? `${words}: ${why}` : words;
}

/** Return how many words are spoken, and how many gestures they have. */
export function describeCounts(words: readonly SpokenWord[]): string {
  if (!words.length) return "no spoken words";
  const gestures = words.flatMap((word) => word.gestures);
  const beats = gestures.filter(({ name }) => isBeat(name)).length;
  const stress = beats ? `, of which ${beats} only ${beats === 1 ? "stresses" : "stress"} the word (beat)` : "";
  return `${count(words.length, "word")}, ${count(gestures.length, "gesture")}${stress}`;
}

const count = (number: number, noun: string): string => `${number} ${noun}${number === 1 ? "" : "s"}`;
