// Sync points of a behaviour, and its phases between them.
import type { Draft, Sync } from "../types.ts";

export interface Phase {
  name: "preparation" | "stroke" | "hold" | "retraction";
  from: number;
  to: number;
}

const MIN_PHASE = 0.005; // [s] shorter phases are not drawn
const MAIN_POINTS = ["stroke", "attackPeak", "ready", "start"];
/** Points that the user can drag on their own. */
const EDGES = ["start", "ready", "strokeStart", "attackPeak", "strokeEnd", "relax", "end"];

/** Sync points of a behaviour, by name. */
export type Points = ReadonlyMap<string, Sync>;

/** Return the sync points of every behaviour of a draft. */
export function pointsOf(draft: Draft): Map<string, Map<string, Sync>> {
  const found = new Map<string, Map<string, Sync>>();
  for (const sync of draft.syncs) {
    const own = found.get(sync.behaviour) ?? new Map<string, Sync>();
    found.set(sync.behaviour, own.set(sync.sync, sync));
  }
  return found;
}

/** Return the first and last planned time [s]. */
export function spanOf(points: Points): { from: number; to: number } {
  const times = [...points.values()].map((sync) => sync.planned);
  return { from: Math.min(...times), to: Math.max(...times) };
}

/** Return the point that falls on a word: the stroke, or the point that is nearest to it in meaning. */
export const mainPoint = (points: Points): Sync | undefined =>
  MAIN_POINTS.map((name) => points.get(name)).find((sync) => sync !== undefined);

/** Return the boundaries of the phases in chronological order. */
export const edgesOf = (points: Points): Sync[] =>
  EDGES.map((name) => points.get(name)).filter((sync) => sync !== undefined);

/** Return the phases of a behaviour with some duration. */
export function phasesOf(points: Points): Phase[] {
  const at = (...names: string[]) => names.map((name) => points.get(name)?.planned).find((time) => time !== undefined);
  const [start, end] = [at("start"), at("end")];
  const ready = at("ready", "attackPeak", "strokeStart", "relax");
  if (start === undefined || end === undefined || ready === undefined) return []; // speech and pauses
  const relax = at("relax") ?? end;
  const [strokeStart, strokeEnd] = [at("strokeStart") ?? relax, at("strokeEnd") ?? relax];
  const phases: Phase[] = [
    { name: "preparation", from: start, to: ready },
    { name: "hold", from: ready, to: strokeStart },
    { name: "stroke", from: strokeStart, to: strokeEnd },
    { name: "hold", from: strokeEnd, to: relax },
    { name: "retraction", from: relax, to: end },
  ];
  return phases.filter(({ from, to }) => to - from > MIN_PHASE);
}
