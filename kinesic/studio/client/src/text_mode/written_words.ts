// Words of the speeches in the text of a document, before it is planned.
import { findAttribute, findTags, isMark, unescapeXml } from "../xml.ts";

/** Word with the preceding mark of its speech, and its index among the words after this mark. */
export interface WrittenWord {
  speech: string;
  mark: string;
  index: number;
  text: string;
  /** Pause before it [s]; 0 without one. */
  pause: number;
}

const START = "start"; // stands for the beginning of a speech instead of a mark
const DURATION = /^\s*([\d.]+)\s*(m?s)\s*$/; // of a pause, such as 0.5s or 500ms

/** Return all spoken words of a document in order. */
export function readWords(text: string): WrittenWord[] {
  const tags = findTags(text);
  return tags.flatMap((tag, first) => {
    const speech = tag.name === "speech" && !tag.closing && !tag.empty ? findAttribute(tag, "id")?.value : undefined;
    if (speech === undefined) return [];
    const inside = tags.slice(
      first + 1,
      tags.findIndex((each, k) => k > first && each.closing && each.name === tag.name),
    );
    const begin = inside.findIndex(({ name, closing }) => name === "text" && !closing);
    const end = inside.findIndex(({ name, closing }) => name === "text" && closing);
    return begin < 0 || end < 0 ? [] : readPieces(text, inside.slice(begin, end + 1), speech);
  });
}

/** Text after a mark, with the positions and durations [s] of its pauses. */
interface Piece {
  mark: string;
  text: string;
  pauses: { at: number; duration: number }[];
}

/** Return the words between tags; only marks and blanks divide words. */
function readPieces(text: string, tags: ReturnType<typeof findTags>, speech: string): WrittenWord[] {
  const pieces: Piece[] = [{ mark: START, text: "", pauses: [] }];
  for (const [k, tag] of tags.entries()) {
    if (isMark(tag) && !tag.closing) pieces.push({ mark: findAttribute(tag, "id")?.value ?? "", text: "", pauses: [] });
    const piece = pieces.at(-1)!;
    if (tag.name === "break" && !tag.closing) piece.pauses.push({ at: piece.text.length, duration: readDuration(tag) });
    const next = tags[k + 1];
    if (next) piece.text += unescapeXml(text.slice(tag.to, next.from).replace(/<!--[\s\S]*?-->/g, ""));
  }
  let pending = 0; // [s] of pauses behind the last word
  return pieces.flatMap(({ mark, text: words, pauses }) => {
    let begin = -1;
    const sum = (end: number) =>
      pauses.filter(({ at }) => at > begin && at <= end).reduce((total, { duration }) => total + duration, 0);
    const found = [...words.matchAll(/\S+/g)].map(({ 0: word, index: at }, index) => {
      const pause = pending + sum(at);
      [begin, pending] = [at, 0];
      return { speech, mark, index, text: word, pause };
    });
    pending += sum(words.length);
    return found;
  });
}

/** Return the duration [s] of a pause; 0 if it is not written as a time. */
function readDuration(tag: ReturnType<typeof findTags>[number]): number {
  const [, value, unit] = DURATION.exec(findAttribute(tag, "time")?.value ?? "") ?? [];
  return value === undefined ? 0 : Number(value) / (unit === "ms" ? 1000 : 1);
}
