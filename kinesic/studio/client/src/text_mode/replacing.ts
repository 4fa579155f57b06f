// Edits of text mode: another gesture at a word, or a first one.
import { append, mark, remove, setAttribute, setManner } from "../edits.ts";
import type { Word } from "../tracks/words.ts";
import { BLOCK, escapeXml, findAttribute, tagWithId } from "../xml.ts";
import type { ShownGesture } from "./spoken.ts";

const WRITTEN_ID = "said"; // id of the blocks that the server writes for a text

/** Gesture that an author chooses for a word. */
export interface Choice {
  id: string;
  why: string;
}

/** Show a chosen gesture at a word instead of the present one, with its reason; null: no gesture before. */
export function choose(text: string, word: Word, present: ShownGesture | null, choice: Choice): string {
  const reason = `chosen: ${choice.why}`;
  if (present?.type !== "gesture") return addAt(present ? remove(text, present.id) : text, word, choice.id, reason);
  const changed = setAttribute(text, present.id, "lexeme", choice.id);
  const anyHand = setAttribute(changed, present.id, "mode", null); // the hand was chosen for the other gesture
  return setManner(anyHand, present.id, "reason", reason);
}

function addAt(text: string, word: Word, lexeme: string, reason: string): string {
  const marked = mark(text, word.speech, word.mark, word.index);
  const stroke = escapeXml(`${word.speech}:${marked.mark}`);
  const added = append(
    marked.text,
    "g",
    (prefix, id) => `<${prefix}gesture id="${id}" lexeme="${escapeXml(lexeme)}" stroke="${stroke}"/>`,
  );
  return added ? setManner(added.text, added.id, "reason", reason) : text;
}

/** Whether a document was written by text mode, so that another text may replace it. */
export function isWritten(text: string): boolean {
  const root = tagWithId(text, BLOCK);
  return root !== undefined && findAttribute(root, "id")?.value === WRITTEN_ID;
}
