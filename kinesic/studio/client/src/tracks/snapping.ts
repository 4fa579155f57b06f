// Times that attract a dragged point: words, accents of the voice, and strokes of other behaviours.
import type { Draft } from "../types.ts";
import { mainPoint, pointsOf } from "./phases.ts";
import type { Word } from "./words.ts";

/** Place in time at which a point can be dropped. */
export type Target =
  | { kind: "word"; word: Word }
  | { kind: "accent"; speech: string; mark: string; offset: number }
  | { kind: "stroke"; behaviour: string; sync: string }
  | { kind: "free" };

export interface Snap {
  time: number;
  target: Target;
  /** Description for the user. */
  says: string;
}

/** Return all times that attract a point of some behaviours, in the order of preference. */
export function listSnaps(draft: Draft, words: readonly Word[], dragged: ReadonlySet<string>): Snap[] {
  const starts = words.map((word) => ({ time: word.start, target: { kind: "word", word } as const, says: word.text }));
  const accents = draft.accents.flatMap((time): Snap[] => {
    const piece = draft.words.find(({ start, end, speech }) => start <= time && time < end && !dragged.has(speech));
    if (!piece) return [];
    const { speech, mark } = piece;
    return [{ time, target: { kind: "accent", speech, mark, offset: time - piece.start }, says: "accent" }];
  });
  const strokes = [...pointsOf(draft)].flatMap(([behaviour, points]): Snap[] => {
    const stroke = points.get("stroke") ?? points.get("attackPeak");
    if (dragged.has(behaviour) || !stroke || stroke !== mainPoint(points)) return [];
    const { sync, planned } = stroke;
    return [{ time: planned, target: { kind: "stroke", behaviour, sync }, says: `stroke of ${behaviour}` }];
  });
  return [...starts.filter(({ target }) => !dragged.has(target.word.speech)), ...strokes, ...accents];
}

/** Return the nearest snap within a tolerance [s]; at equal distance the first. */
export function nearest(snaps: readonly Snap[], time: number, tolerance: number): Snap | undefined {
  const close = snaps.filter((snap) => Math.abs(snap.time - time) <= tolerance);
  return close.reduce<Snap | undefined>(
    (best, snap) => (best && Math.abs(best.time - time) <= Math.abs(snap.time - time) ? best : snap),
    undefined,
  );
}
