// Movements and pauses that a person has added, which stay when gestures are chosen for a changed text.
import { type Anchor, readAnchor, writeAnchor } from "../anchors.ts";
import { mark, setAttribute } from "../edits.ts";
import { typeWords } from "../plain_words.ts";
import { copyAll, paste } from "../tracks/clipboard.ts";
import { readPins } from "../tracks/group_edits.ts";
import { pauseBefore } from "../tracks/pauses.ts";
import { type Points, pointsOf } from "../tracks/phases.ts";
import type { Draft } from "../types.ts";
import { findAttribute, findTags, tagWithId } from "../xml.ts";
import { alignWords } from "./alignment.ts";
import { isChosen, type SpokenWord } from "./spoken.ts";
import { readWords } from "./written_words.ts";

const NO_MOVEMENTS: readonly string[] = ["speech", "constraint"]; // elements that are no movement
/** Points that decide the word of a movement, the most significant first. */
const MAIN_POINTS = ["stroke", "attackPeak", "strokeStart", "ready", "start"] as const;

/** Document that a text has replaced, with its words and its newest plan. */
export interface Former {
  text: string;
  words: readonly SpokenWord[];
  draft: Draft | null;
}

/** Document with the additions of the former one, the number of movements, and those that have lost their word. */
export interface KeptAdditions {
  text: string;
  count: number;
  gone: string[];
}

/** Put added movements and pauses of the former document into the document of a changed text. */
export function keepAdditions(former: Former, changed: string): KeptAdditions {
  const text = keepPauses(former.text, changed);
  const ids = listAdded(former);
  const aligned = align(former.words, text);
  const isGone = (id: string) => {
    const place = findWritten(former, id);
    return place >= 0 && !aligned.has(place);
  };
  const staying = ids.filter((id) => !isGone(id));
  const clip = copyAll(former.text, staying, readTimes(former, staying));
  const pasted = paste(text, clip, clip.origin);
  const placed = pasted.ids.reduce((present, id, index) => {
    const pins = [...readPins(present, id)].flatMap(([point, value]) => {
      const anchor = readAnchor(value);
      return anchor?.reference === null ? [[point, anchor.offset] as const] : [];
    });
    const main = mainOf(new Map(pins));
    if (main === undefined) return present; // follows another addition
    const place = placeAt(former, main, findWritten(former, clip.items[index]!.id), aligned, present);
    return pins.reduce(
      (now, [point, time]) => setAttribute(now, id, point, writeAnchor(place.anchor, time - main)),
      place.text,
    );
  }, pasted.text);
  const gone = ids.filter(isGone).map((id) => {
    const word = former.words[findWritten(former, id)]!;
    return `What you added for “${word.text}” (${typeWords(tagWithId(former.text, id)!.name)})`;
  });
  return { text: placed, count: staying.length, gone };
}

/** Put the pauses of a former document before the same words, where the changed one has none. */
function keepPauses(former: string, changed: string): string {
  const words = readWords(former);
  return [...align(words, changed)].reduce((text, [index, place]) => {
    const { pause } = words[index]!;
    const word = readWords(text)[place]!;
    return pause && !word.pause ? (pauseBefore(text, word, pause) ?? text) : text;
  }, changed);
}

/** Return the value of the point that decides the word of a movement. */
const mainOf = <V>(pins: ReadonlyMap<string, V>): V | undefined =>
  MAIN_POINTS.map((point) => pins.get(point)).find((value) => value !== undefined);

/** Return the block times [s] of movements by their points: as written, or else as the plan has them. */
function readTimes(former: Former, ids: readonly string[]): Map<string, Map<string, number>> {
  const { draft, text, words } = former;
  const zero = draft?.zero ?? 0;
  const points = draft ? pointsOf(draft) : new Map<string, Points>();
  return new Map(
    ids.map((id) => {
      const planned = [...(points.get(id) ?? [])].map(([point, { asked }]) => [point, asked - zero] as const);
      const written = [...readPins(text, id)].flatMap(([point, value]) => {
        const anchor = readAnchor(value);
        const word = anchor && words[findWord(words, anchor.reference)];
        if (anchor?.reference === null) return [[point, anchor.offset] as const];
        return word ? [[point, word.start - zero + anchor.offset] as const] : [];
      });
      return [id, new Map([...planned, ...written])];
    }),
  );
}

/** Return the index in a document for each word that it shares with a former text. */
const align = (words: readonly { text: string }[], changed: string): Map<number, number> =>
  alignWords(
    words.map(({ text }) => text),
    readWords(changed).map(({ text }) => text),
  );

/** Return the ids of movements that no intent has chosen; gestures that are picked for a word are kept with it. */
function listAdded({ text, words }: Former): string[] {
  const picked = new Set(
    words.flatMap(({ gestures }) => gestures.filter(({ type }) => type === "gesture")).map(({ id }) => id),
  );
  let depth = 0;
  return findTags(text).flatMap((tag) => {
    if (tag.closing) depth -= 1;
    const isOutermost = depth === 1 && !tag.closing && !NO_MOVEMENTS.includes(tag.name);
    if (!tag.closing && !tag.empty) depth += 1;
    const id = isOutermost ? findAttribute(tag, "id")?.value : undefined;
    return id === undefined || picked.has(id) || isChosen(tag) ? [] : [id];
  });
}

/** Return the index of the word on which a person has put a movement, or -1. */
function findWritten({ text, words }: Former, id: string): number {
  const main = mainOf(readPins(text, id));
  return findWord(words, (main && readAnchor(main)?.reference) ?? null);
}

/** Return the index of the first word after the mark of a reference such as s:m1, or -1. */
const findWord = (words: readonly SpokenWord[], reference: string | null): number =>
  words.findIndex(
    ({ speech, mark: name, index }) => index === 0 && name !== "start" && reference === `${speech}:${name}`,
  );

/** Return the place of a block time [s] of the former document in another one, and that one with the mark for it. */
function placeAt(
  { words, draft }: Former,
  time: number,
  written: number,
  aligned: ReadonlyMap<number, number>,
  text: string,
): { text: string; anchor: Anchor } {
  const at = time + (draft?.zero ?? 0);
  const last = words.at(-1);
  const places = readWords(text);
  const final = places.at(-1);
  if (written < 0 && last && final && at > last.end)
    return { text, anchor: { reference: `${final.speech}:end`, offset: at - last.end } };
  const common = [...aligned.keys()].sort((a, b) => a - b);
  const index = written >= 0 ? written : (common.findLast((each) => words[each]!.start <= at) ?? common[0] ?? -1);
  const place = places[aligned.get(index) ?? -1];
  if (!place) return { text, anchor: { reference: null, offset: time } };
  const marked = mark(text, place.speech, place.mark, place.index);
  const reference = `${place.speech}:${marked.mark}`;
  return { text: marked.text, anchor: { reference, offset: at - words[index]!.start } };
}

/** Tell which additions stay, and which have lost their words. */
export function describeAdditions({ count, gone }: Omit<KeptAdditions, "text">): string[] {
  const stay =
    count === 1
      ? "The movement that you added yourself stays."
      : `The ${count} movements that you added yourself stay.`;
  return [...(count ? [stay] : []), ...gone.map((what) => `${what} is gone with its word.`)];
}
