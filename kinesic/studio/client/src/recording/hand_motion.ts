// Recorded motion of hands, thinned to the key poses of a gesture.
import { formatPosition, type Place } from "../toml.ts";
import type { Side } from "../types.ts";

const SIDES: readonly Side[] = ["left", "right"];
const MIN_TRAVEL = 0.08; // [arm lengths] shorter motion of a hand counts as rest
const TOLERANCE = 0.04; // [arm lengths] distance of the key poses' lines from the recorded path
const MAX_POSES = 8; // largest number of key poses

/** Positions of both hands at one time, in arm lengths. */
export type HandSample = Readonly<Record<Side, Place>>;

/** Return the TOML file of a gesture that follows recorded hands; `says` describes it; null if no hand has moved. */
export function writeGesture(id: string, samples: readonly HandSample[], says: string): string | null {
  const moved = SIDES.filter((side) =>
    samples.some((sample) => distance(sample[side], samples[0]![side]) > MIN_TRAVEL),
  );
  if (!moved.length) return null;
  const poses = selectPoses(trim(samples, moved), moved).map((sample) => {
    const hands = moved.map((side) => `${side} = { at = ${formatPosition(sample[side])} }`);
    return `  { ${hands.join(", ")} },\n`;
  });
  return `category = "metaphoric"\n\n[[gesture]]\nid = "${id}"\nsays = "${says}"\nkeys = [\n${poses.join("")}]\n`;
}

const distance = (a: Place, b: Place): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Leave out the rest before and after the motion, except for one sample each. */
function trim(samples: readonly HandSample[], sides: readonly Side[]): HandSample[] {
  const isAway = (other: HandSample) => (sample: HandSample) =>
    sides.some((side) => distance(sample[side], other[side]) > TOLERANCE);
  const first = samples.findIndex(isAway(samples[0]!));
  const last = samples.findLastIndex(isAway(samples.at(-1)!));
  return samples.slice(Math.max(first - 1, 0), last + 2);
}

/** Select the samples between which straight lines follow the path, at most `MAX_POSES`, the worst deviation first. */
function selectPoses(samples: readonly HandSample[], sides: readonly Side[]): HandSample[] {
  const poses = samples.length > 1 ? [0, samples.length - 1] : [0];
  while (poses.length < MAX_POSES) {
    const worst = findWorst(samples, sides, poses);
    if (worst.error <= TOLERANCE) break;
    poses.splice(
      poses.findIndex((pose) => pose > worst.at),
      0,
      worst.at,
    );
  }
  return poses.map((pose) => samples[pose]!);
}

/** Return the sample that is farthest from the lines between the selected ones. */
function findWorst(samples: readonly HandSample[], sides: readonly Side[], poses: readonly number[]) {
  const worst = { at: 0, error: 0 };
  for (const [k, to] of poses.entries())
    for (let at = poses[k - 1] ?? to; at < to; at++) {
      const [from, until] = [samples[poses[k - 1]!]!, samples[to]!];
      const error = Math.max(...sides.map((side) => offLine(samples[at]![side], from[side], until[side])));
      if (error > worst.error) Object.assign(worst, { at, error });
    }
  return worst;
}

/** Return the distance of a point from the line between two others. */
function offLine(point: Place, from: Place, to: Place): number {
  const length = distance(from, to) ** 2;
  const along = length && point.reduce((sum, value, k) => sum + (value - from[k]!) * (to[k]! - from[k]!), 0) / length;
  const part = Math.min(1, Math.max(0, along));
  return distance(point, [0, 1, 2].map((k) => from[k]! + part * (to[k]! - from[k]!)) as unknown as Place);
}
