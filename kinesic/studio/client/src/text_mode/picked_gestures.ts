// Gestures that a person has picked, which stay on their words when gestures are chosen for a changed text.
import { POINTS, setAttribute, setKinesicAttribute } from "../edits.ts";
import { findAttribute, findTags, type Tag, tagWithId } from "../xml.ts";
import { alignWords } from "./alignment.ts";
import { placeGesture } from "./replacing.ts";
import { findShown, isChosen, PICKED_PREFIX, type ShownGesture, type SpokenWord } from "./spoken.ts";
import { readWords, type WrittenWord } from "./written_words.ts";

const PLACED_ANEW: readonly string[] = [...POINTS, "id", "lexeme"]; // attributes that a new place decides

/** Document with the picked gestures, how many it has, and the words of those that are gone. */
export interface Kept {
  text: string;
  count: number;
  gone: string[];
}

/** Put the picked gestures of the former document into the document of a changed text. */
export function keepPicked(former: string, words: readonly SpokenWord[], changed: string): Kept {
  const places = readWords(changed);
  const aligned = alignWords(
    words.map(({ text }) => text),
    places.map(({ text }) => text),
  );
  let text = changed;
  let count = 0;
  const gone: string[] = [];
  for (const [index, word] of words.entries())
    for (const gesture of word.gestures.filter(({ isPicked, type }) => isPicked && type === "gesture")) {
      const place = places[aligned.get(index) ?? -1];
      if (place) {
        text = put(former, gesture, text, findShown(text, readWords(text))[aligned.get(index)!]!);
        count += 1;
      } else gone.push(word.text);
    }
  return { text, count, gone };
}

/** Show a gesture of the former document at a word, with its hand, style and reason. */
function put(
  former: string,
  gesture: ShownGesture,
  text: string,
  word: WrittenWord & { gestures: ShownGesture[] },
): string {
  const present = word.gestures.find(({ isPicked }) => !isPicked) ?? null;
  const placed = placeGesture(text, word, present, gesture.name);
  const tag = tagWithId(former, gesture.id);
  const own = (placed && tagWithId(placed.text, placed.id)?.attributes) ?? [];
  if (!placed || !tag) return text;
  const cleared = own
    .filter(({ name }) => !PLACED_ANEW.includes(name))
    .reduce((bare, { name }) => setAttribute(bare, placed.id, name, null), placed.text);
  return tag.attributes
    .filter(({ name }) => !PLACED_ANEW.includes(name) && !name.startsWith("xmlns"))
    .reduce(
      (present, { name, value }) =>
        name.includes(":")
          ? setKinesicAttribute(present, placed.id, name.slice(name.indexOf(":") + 1), value)
          : setAttribute(present, placed.id, name, value),
      cleared,
    );
}

/** Mark chosen gestures whose attributes an edit has changed as picked, so that they stay, too. */
export function markEdited(before: string, after: string): string {
  const edited = findTags(after).flatMap((tag) => {
    const id = tag.closing || tag.name !== "gesture" || !isChosen(tag) ? undefined : findAttribute(tag, "id")?.value;
    const former = id === undefined ? undefined : tagWithId(before, id);
    return id !== undefined && former && listValues(former) !== listValues(tag) ? [id] : [];
  });
  return edited.reduce((text, id) => {
    const reason = findAttribute(tagWithId(text, id)!, "reason")?.value ?? "";
    return setKinesicAttribute(text, id, "reason", PICKED_PREFIX + reason);
  }, after);
}

const listValues = (tag: Tag): string => JSON.stringify(tag.attributes.map(({ name, value }) => [name, value]).sort());

/** Tell which picked gestures stay, and which have lost their words. */
export function describeKept({ count, gone }: Omit<Kept, "text">): string[] {
  const stay = count === 1 ? "The gesture that you picked stays." : `The ${count} gestures that you picked stay.`;
  const lost = gone.map((word) => `The gesture that you picked for “${word}” is gone with its word.`);
  return [...(count ? [stay] : []), ...lost];
}
