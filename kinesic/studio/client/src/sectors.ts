// McNeill's sectors of gesture space: the sector of a position, and their grid over the stage.
import type { Body, Side } from "./types.ts";
import { project, type Vector } from "./vectors.ts";

const SVG = "http://www.w3.org/2000/svg";
const DEFAULT_DEPTH = "ZMiddle"; // depth of the grid without a drag
type Axis = "x" | "y" | "z";
export type Sector = Record<Axis, string>;

/** Return the sector of a world position [m] for one hand. */
export function findSector(body: Body, side: Side, place: readonly number[]): Sector {
  const { gesture_origin: origin, arm_length: size, sectors } = body;
  const [forward, left, up] = place.map((value, k) => (value - origin[k]!) / size) as [number, number, number];
  const at: Record<Axis, number> = { x: side === "left" ? left : -left, y: up, z: forward };
  const nearest = (axis: Axis) =>
    Object.entries(sectors[axis]).reduce((best, each) =>
      Math.abs(each[1] - at[axis]) < Math.abs(best[1] - at[axis]) ? each : best,
    )[0];
  return { x: nearest("x"), y: nearest("y"), z: nearest("z") };
}

/** Return sorted centres with the bounds around each. */
function bands(centres: Record<string, number>): { name: string; from: number; to: number }[] {
  const sorted = Object.entries(centres).sort((a, b) => a[1] - b[1]);
  return sorted.map(([name, centre], k) => {
    const below = sorted[k - 1]?.[1];
    const above = sorted[k + 1]?.[1];
    const half = ((above ?? centre) - centre || centre - (below ?? centre)) / 2;
    return {
      name,
      from: below === undefined ? centre - half : (below + centre) / 2,
      to: above === undefined ? centre + half : (centre + above) / 2,
    };
  });
}

export class SectorGrid {
  shown = false;
  private drawn = ""; // input of the drawn grid, which is rebuilt only after a change

  constructor(
    private readonly svg: SVGSVGElement,
    private readonly body: Body,
  ) {}

  /**
   * Draw the sectors of a hand at the hand's depth.
   * @param view matrix from scene to canvas
   * @param up transformation from world to scene
   * @param place world position of the hand [m]; null without a drag
   * @param size size of the stage [CSS pixels]
   */
  draw(
    view: Float32Array,
    up: readonly number[],
    side: Side,
    place: readonly number[] | null,
    size: { width: number; height: number },
  ): void {
    this.svg.toggleAttribute("hidden", !this.shown && place === null);
    if (this.svg.hasAttribute("hidden")) return;
    const now = place && findSector(this.body, side, place);
    const depth = this.body.sectors.z[now?.z ?? DEFAULT_DEPTH]!;
    const about = [...view, size.width, size.height, side, now?.x, now?.y, now?.z].join();
    if (about === this.drawn) return;
    this.drawn = about;
    const cells = bands(this.body.sectors.y).flatMap((y) =>
      bands(this.body.sectors.x).map((x) => {
        const corners = [
          [x.from, y.from],
          [x.to, y.from],
          [x.to, y.to],
          [x.from, y.to],
        ].map(([outward, high]) => {
          const seen = project(view, this.place(side, outward!, high!, depth, up));
          return [((seen.x + 1) / 2) * size.width, ((1 - seen.y) / 2) * size.height] as const;
        });
        return this.cell(`${x.name} ${y.name}`, corners, x.name === now?.x && y.name === now?.y);
      }),
    );
    this.svg.replaceChildren(...cells);
  }

  /** Convert a position (outward, up, forward in arm lengths) to the scene. */
  private place(side: Side, outward: number, high: number, forward: number, up: readonly number[]): Vector {
    const left = side === "left" ? outward : -outward;
    const [x, y, z] = [forward, left, high].map(
      (value, k) => this.body.gesture_origin[k]! + this.body.arm_length * value + up[k]!,
    );
    return [x!, y!, z!];
  }

  private cell(name: string, corners: (readonly [number, number])[], current: boolean): SVGElement {
    const group = document.createElementNS(SVG, "g");
    group.classList.toggle("current", current);
    const outline = document.createElementNS(SVG, "polygon");
    outline.setAttribute("points", corners.map((corner) => corner.join(",")).join(" "));
    const label = document.createElementNS(SVG, "text");
    const middle = (k: 0 | 1) => String(corners.reduce((sum, corner) => sum + corner[k], 0) / corners.length);
    label.setAttribute("x", middle(0));
    label.setAttribute("y", middle(1));
    label.textContent = current ? name : "";
    group.append(outline, label);
    return group;
  }
}
