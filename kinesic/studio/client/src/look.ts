// From where the robot is seen, and how that changes.
import type { Look } from "kinesic:scene";
import type { Body } from "./types.ts";

export const VIEWS = ["front", "left", "top", "free"] as const;
export type View = (typeof VIEWS)[number];

const LOWEST = -0.1; // [rad] from which one looks up at it
const HIGHEST = 1.5;

/** How keys turn it, about the robot and up [rad]. */
export const TURNS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [0.1, 0],
  ArrowRight: [-0.1, 0],
  ArrowUp: [0, 0.1],
  ArrowDown: [0, -0.1],
};

/** One of the usual sides. */
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

/** As it is seen after a turn about the robot, and up or down [rad]. */
export const turned = (look: Look, turn: number, rise: number): Look => ({
  ...look,
  turn: look.turn + turn,
  rise: Math.min(Math.max(look.rise + rise, LOWEST), HIGHEST),
});

/** As it is seen from nearer, or farther away. */
export const zoomed = (look: Look, factor: number): Look => ({
  ...look,
  zoom: Math.min(Math.max(look.zoom * factor, 0.5), 6),
});
