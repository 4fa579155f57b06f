// Spoken words of a draft with their times.
import type { Draft } from "../types.ts";

export interface Word {
  speech: string;
  mark: string; // preceding mark
  index: number; // index among the words after the mark
  text: string;
  start: number;
  end: number;
}

/** Return the words of a draft; times between two marks are proportional to letters. */
export function listWords(draft: Draft): Word[] {
  return draft.words.flatMap(({ speech, mark, text, start, end }) => {
    const perLetter = (end - start) / Math.max(1, text.length);
    return [...text.matchAll(/\S+/g)].map((match, index) => ({
      speech,
      mark,
      index,
      text: match[0],
      start: start + perLetter * match.index,
      end: start + perLetter * (match.index + match[0].length),
    }));
  });
}
