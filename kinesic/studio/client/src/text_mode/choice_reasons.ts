// Explanations of a chosen gesture: why it is not the first of the list, and why it uses the left hand.
import { gestureWords, labelWords } from "../plain_words.ts";
import { pointsOf, spanOf } from "../tracks/phases.ts";
import type { Draft } from "../types.ts";
import type { Alternative } from "./alternatives.ts";
import type { ShownGesture, SpokenWord } from "./spoken.ts";

const REPEAT_INTERVAL = 60; // [s] within which the server avoids to repeat a gesture

/** Tell why a word does not show the gestures that rank before its own; empty if there are none. */
export function explainRank(
  word: SpokenWord,
  present: ShownGesture,
  alternatives: readonly Alternative[],
  words: readonly SpokenWord[],
): string {
  const rank = alternatives.findIndex(({ id }) => id === present.name);
  if (rank <= 0 || present.isPicked) return "";
  const passed = alternatives.slice(0, rank).map(({ id }) => ({ id, at: findNear(id, word, words) }));
  const repeated = passed.flatMap(({ id, at }) => (at ? [`${gestureWords(id)} is shown at “${at.text}” already`] : []));
  const others = passed.filter(({ at }) => !at).map(({ id }) => gestureWords(id));
  const varied = others.length
    ? [
        `${others.join(", ")} ${others.length === 1 ? "fits" : "fit"} as well; the choice varies with style and neighbours`,
      ]
    : [];
  return `Number ${rank + 1} of the list: ${[...repeated, ...varied].join("; ")}.`;
}

/** Return the nearest other word that shows a gesture within the interval without repetitions. */
function findNear(gesture: string, word: SpokenWord, words: readonly SpokenWord[]): SpokenWord | undefined {
  const distance = (other: SpokenWord) => Math.abs(other.start - word.start);
  return words
    .filter((other) => other !== word && distance(other) < REPEAT_INTERVAL)
    .filter((other) => other.gestures.some(({ name }) => name === gesture))
    .sort((a, b) => distance(a) - distance(b))[0];
}

/** Tell why a gesture uses the left hand alone; empty for other hands. */
export function explainHand(id: string, hand: string | undefined, draft: Draft): string {
  const tracksOf = (behaviour: string) => draft.behaviours.find((each) => each.id === behaviour)?.tracks ?? [];
  const isLeft = tracksOf(id).includes("l_hand") && !tracksOf(id).includes("r_hand");
  if (!isLeft) return "";
  if (hand !== undefined) return "Left hand: the document asks for it.";
  const points = pointsOf(draft);
  const own = points.get(id);
  const span = own && spanOf(own);
  const busy = draft.behaviours.find(({ id: other, tracks }) => {
    const isRight = tracks.includes("r_hand") && !tracks.includes("l_hand");
    const times = isRight && other !== id ? points.get(other) : undefined;
    return times && span && spanOf(times).from < span.to && span.from < spanOf(times).to;
  });
  return busy
    ? `Left hand: the right hand shows ${labelWords(busy.type, busy.label)} at this time.`
    : "Left hand: the gesture is made with it.";
}
