// Draggable parts on the stage: hands, elbows, the trunk at its neck, and the gaze target.
import { make } from "./dom.ts";
import type { Body, Side } from "./types.ts";
import { project, type Vector } from "./vectors.ts";

const GRAB_RADIUS = 24; // [CSS pixels] radius in which a handle is grabbed
const GAZE_DISTANCE = 0.45; // [m] distance of the gaze target from the eyes
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

/** Return the handles of a body; without a neck it has neither trunk nor gaze. */
export function listHandles(body: Body): Handle[] {
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

/** Return the position of a handle in the scene for the given segment frames. */
export function handlePosition(body: Body, { part, side }: Handle, frames: Float32Array[]): Vector {
  const own = side[0] as "l" | "r";
  if (part === "gaze" && body.eyes) {
    const frame = frames[body.eyes.segment]!;
    const [x, y, z] = at(frame, body.eyes.at, 1);
    const way = at(frame, body.eyes.facing, 0);
    return [x + GAZE_DISTANCE * way[0], y + GAZE_DISTANCE * way[1], z + GAZE_DISTANCE * way[2]];
  }
  const segment = part === "trunk" ? body.neck! : part === "elbow" ? body.elbows[own] : body.hands[own];
  return at(frames[segment]!, [0, 0, 0], 1);
}

/** Small circles over the stage that mark draggable parts; moving them causes no repaint. */
export class Handles {
  readonly all: Handle[];
  private readonly dots: HTMLElement[];

  constructor(
    private readonly cover: HTMLElement,
    private readonly body: Body,
  ) {
    this.all = listHandles(body);
    this.dots = this.all.map(({ part }) => make("i", { class: part }));
    cover.replaceChildren(...this.dots);
  }

  /** Positions on the canvas [CSS pixels] from its corner. */
  points(view: Float32Array, frames: Float32Array[], area: { width: number; height: number }): Point[] {
    return this.all.map((handle) => {
      const seen = project(view, handlePosition(this.body, handle, frames));
      return { x: ((seen.x + 1) / 2) * area.width, y: ((1 - seen.y) / 2) * area.height };
    });
  }

  /**
   * Move the circles.
   * @param taken handle under the pointer
   * @param alone whether it is dragged, so that no other handle can be grabbed
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

  /** Return the handle at a point; a hand wins over other handles at the same distance. */
  under(points: readonly Point[], { x, y }: Point): Handle | null {
    const far = points.map((each, k) => Math.hypot(each.x - x, each.y - y) - (this.all[k]!.part === "hand" ? 6 : 0));
    const nearest = far.indexOf(Math.min(...far));
    return far[nearest]! <= GRAB_RADIUS ? this.all[nearest]! : null;
  }
}
