// Viewpoints of the robot and their changes.
import type { Look } from "kinesic:scene";
import type { Body } from "./types.ts";

export const VIEWS = ["front", "left", "top", "free"] as const;
export type View = (typeof VIEWS)[number];

const MIN_ELEVATION = -0.1; // [rad] lowest elevation
const HIGHEST = 1.5;

/** Rotation by the arrow keys: azimuth and elevation [rad]. */
export const TURNS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [0.1, 0],
  ArrowRight: [-0.1, 0],
  ArrowUp: [0, 0.1],
  ArrowDown: [0, -0.1],
};

/** Return one of the standard views. */
export function lookFrom(view: View, body: Body): Look {
  const [x, y, z] = body.view.from as [number, number, number];
  const sides: Record<View, Look> = {
    free: { turn: Math.atan2(y, x), rise: Math.asin(z / Math.hypot(x, y, z)), zoom: 1 },
    front: { turn: 0, rise: 0.05, zoom: 1 },
    left: { turn: Math.PI / 2, rise: 0.05, zoom: 1 },
    top: { turn: 0, rise: 1.5, zoom: 1 },
  };
  return sides[view];
}

/** Rotate the view by azimuth and elevation [rad]. */
export const turned = (look: Look, turn: number, rise: number): Look => ({
  ...look,
  turn: look.turn + turn,
  rise: Math.min(Math.max(look.rise + rise, MIN_ELEVATION), HIGHEST),
});

/** Move the viewpoint closer or farther. */
export const zoomed = (look: Look, factor: number): Look => ({
  ...look,
  zoom: Math.min(Math.max(look.zoom * factor, 0.5), 6),
});
