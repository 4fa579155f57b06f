// Positions in gesture space: arm lengths outward, up and forward from its origin.
import type { Place } from "./toml.ts";
import type { Body, Side } from "./types.ts";

/** Convert a position [m] to arm lengths: outward, up, forward. */
export function toArmLengths(body: Body, side: Side, place: readonly number[]): Place {
  const { gesture_origin: origin, arm_length: size } = body;
  const [x, y, z] = place.map((value, k) => (value - origin[k]!) / size) as [number, number, number];
  return [side === "left" ? y : -y, z, x];
}
