// What can be dragged on the stage: hands, elbows, the trunk by its neck, and the place that the eyes look at.
import { make } from "./dom.ts";
import type { Body, Side } from "./types.ts";
import { project, type Vector } from "./vectors.ts";

const GRIP = 24; // [CSS pixels] around a handle, in which it is taken
const AHEAD = 0.45; // [m] before the eyes, where the place that they look at is shown
export const PARTS = ["hand", "elbow", "trunk", "gaze"] as const;
export type Part = (typeof PARTS)[number];

export interface Handle {
  part: Part;
  side: Side;
}

export interface Point {
  x: number;
  y: number;
}

const BOTH: readonly Side[] = ["left", "right"];

/** The handles of a body; one without a neck has neither trunk nor gaze to be dragged. */
export function handlesOf(body: Body): Handle[] {
  const arms = BOTH.flatMap((side) => [
    { part: "hand" as const, side },
    { part: "elbow" as const, side },
  ]);
  const middle: Handle[] = body.eyes ? [{ part: "gaze", side: "right" }] : [];
  return [...arms, ...middle, ...(body.neck === null ? [] : [{ part: "trunk" as const, side: "right" as const }])];
}

const at = (frame: Float32Array, [x, y, z]: readonly number[], w: 0 | 1): Vector => {
  const row = (k: number) => frame[k]! * x! + frame[k + 4]! * y! + frame[k + 8]! * z! + w * frame[k + 12]!;
  return [row(0), row(1), row(2)];
};

/** Where a handle is in the picture's space, given the frames of all segments. */
export function placeOf(body: Body, { part, side }: Handle, frames: Float32Array[]): Vector {
  const own = side[0] as "l" | "r";
  if (part === "gaze" && body.eyes) {
    const frame = frames[body.eyes.segment]!;
    const [x, y, z] = at(frame, body.eyes.at, 1);
    const way = at(frame, body.eyes.facing, 0);
    return [x + AHEAD * way[0], y + AHEAD * way[1], z + AHEAD * way[2]];
  }
  const segment = part === "trunk" ? body.neck! : part === "elbow" ? body.elbows[own] : body.hands[own];
  return at(frames[segment]!, [0, 0, 0], 1);
}

/** Small circles over the stage, so that one sees what can be dragged; they are moved without being painted anew. */
export class Handles {
  readonly all: Handle[];
  private readonly dots: HTMLElement[];

  constructor(
    private readonly cover: HTMLElement,
    private readonly body: Body,
  ) {
    this.all = handlesOf(body);
    this.dots = this.all.map(({ part }) => make("i", { class: part }));
    cover.replaceChildren(...this.dots);
  }

  /** Where they are on the canvas [CSS pixels], from its corner. */
  points(view: Float32Array, frames: Float32Array[], area: { width: number; height: number }): Point[] {
    return this.all.map((handle) => {
      const seen = project(view, placeOf(this.body, handle, frames));
      return { x: ((seen.x + 1) / 2) * area.width, y: ((1 - seen.y) / 2) * area.height };
    });
  }

  /**
   * Puts the circles where they are.
   * @param taken what is under the pointer
   * @param alone whether it is dragged, and nothing else can be taken meanwhile
   */
  draw(points: readonly Point[], taken: Handle | null, alone: boolean): void {
    this.cover.classList.toggle("alone", alone);
    points.forEach(({ x, y }, k) => {
      const dot = this.dots[k]!;
      const { part, side } = this.all[k]!;
      const is = taken?.part === part && taken.side === side;
      dot.classList.toggle("taken", is);
      if (is || !alone) dot.style.translate = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
    });
  }

  /** The handle at a point; a hand before others that are as near. */
  under(points: readonly Point[], { x, y }: Point): Handle | null {
    const far = points.map((each, k) => Math.hypot(each.x - x, each.y - y) - (this.all[k]!.part === "hand" ? 6 : 0));
    const nearest = far.indexOf(Math.min(...far));
    return far[nearest]! <= GRIP ? this.all[nearest]! : null;
  }
}
