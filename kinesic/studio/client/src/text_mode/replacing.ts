// Edits of text mode: another gesture at a word, or a first one.
import { type Added, append, mark, remove, setAttribute, setKinesicAttribute } from "../edits.ts";
import type { Word } from "../tracks/words.ts";
import { BLOCK, escapeXml, findAttribute, tagWithId } from "../xml.ts";
import { PICKED_PREFIX, type ShownGesture } from "./spoken.ts";

const WRITTEN_ID = "said"; // id of the blocks that the server writes for a text

/** Position of a word in the text of a document. */
type WordPlace = Pick<Word, "speech" | "mark" | "index">;

/** Gesture that an author chooses for a word. */
export interface Choice {
  id: string;
  why: string;
}

/** Show a chosen gesture at a word instead of the present one, with its reason; null: no gesture before. */
export function choose(text: string, word: WordPlace, present: ShownGesture | null, choice: Choice): string {
  const placed = placeGesture(text, word, present, choice.id);
  return placed ? setKinesicAttribute(placed.text, placed.id, "reason", `${PICKED_PREFIX}${choice.why}`) : text;
}

/** Put a gesture at a word instead of the present one; null if the text is no document. */
export function placeGesture(
  text: string,
  word: WordPlace,
  present: ShownGesture | null,
  lexeme: string,
): Added | null {
  if (present?.type !== "gesture") return addAt(present ? remove(text, present.id) : text, word, lexeme);
  const changed = setAttribute(text, present.id, "lexeme", lexeme);
  return { text: setAttribute(changed, present.id, "mode", null), id: present.id }; // the hand was that of the other gesture
}

function addAt(text: string, word: WordPlace, lexeme: string): Added | null {
  const marked = mark(text, word.speech, word.mark, word.index);
  const stroke = escapeXml(`${word.speech}:${marked.mark}`);
  return append(
    marked.text,
    "g",
    (prefix, id) => `<${prefix}gesture id="${id}" lexeme="${escapeXml(lexeme)}" stroke="${stroke}"/>`,
  );
}

/** Whether a document was written by text mode, so that another text may replace it. */
export function isWritten(text: string): boolean {
  const root = tagWithId(text, BLOCK);
  return root !== undefined && findAttribute(root, "id")?.value === WRITTEN_ID;
}
