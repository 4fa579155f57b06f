// Pauses within a speech, written before a word.

import { formatTime } from "../anchors.ts";
import { findWord } from "../edits.ts";
import { findTags, isMark } from "../xml.ts";
import type { Word } from "./words.ts";

const SLIDER_STEP = 0.01; // [s] step of the slider, which may stand this much before the end

/** Return the word that is spoken at a time [s], or comes next in the same speech; undefined outside of speeches. */
export function wordAt<W extends Word>(words: readonly W[], time: number): W | undefined {
  const next = words.find(({ end }) => end > time + SLIDER_STEP);
  const first = next && words.find(({ speech }) => speech === next.speech);
  return first && first.start <= time ? next : undefined;
}

/** Insert a pause [s] before a word and its marks, so that gestures stay on the word; null if it is not found. */
export function pauseBefore(
  text: string,
  { speech, mark, index }: Pick<Word, "speech" | "mark" | "index">,
  duration: number,
): string | null {
  const found = findWord(text, speech, mark, index);
  if (!found) return null;
  let { at } = found;
  for (const tag of findTags(text).toReversed())
    if (isMark(tag) && tag.to <= at && !text.slice(tag.to, at).trim()) at = tag.from;
  return `${text.slice(0, at)}<${found.prefix}break time="${formatTime(duration)}s"/>${text.slice(at)}`;
}
