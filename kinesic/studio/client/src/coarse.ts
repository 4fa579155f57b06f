// Mesh with fewer triangles, drawn during motion.
import { cross, dot, plus, type Vector } from "./vectors.ts";

/** Triangles: position and normal of each corner, and three corner indices per triangle. */
export interface Mesh {
  places: Float32Array;
  normals: Float32Array;
  triangles: Uint32Array;
}

const MAX_CELL_SIZE = 0.02; // [m] largest cell
const MIN_CELLS = 5; // cells along a part, so that fingers keep their shape

/** Return the cell size [m] that preserves the shape of a part. */
export function cellSize(mesh: ArrayLike<number>): number {
  const [low, high] = [Array(3).fill(Number.POSITIVE_INFINITY), Array(3).fill(Number.NEGATIVE_INFINITY)];
  for (let corner = 0; corner < mesh.length; corner += 6)
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], mesh[corner + axis]!);
      high[axis] = Math.max(high[axis], mesh[corner + axis]!);
    }
  return Math.min(MAX_CELL_SIZE, Math.max(...high.map((value, axis) => value - low[axis])) / MIN_CELLS);
}

/**
 * Merge all corners within a grid cell and drop duplicate triangles.
 * Triangles run counterclockwise as seen from outside, by their normals.
 * @param mesh six numbers per corner: position [m] and normal
 * @param corners three corner indices per triangle; default: all corners in order
 * @param cell cell size [m]
 */
export function coarsen(mesh: ArrayLike<number>, corners: ArrayLike<number> | undefined, cell: number): Mesh {
  const first = firstCornerPerCell(mesh, cell); // over the whole mesh, so that parts of one mesh have no gap between them
  const count = corners?.length ?? mesh.length / 6;
  const places: number[] = [];
  const normals: number[] = [];
  const kept = new Map<number, number>(); // corner of the mesh -> corner of the result
  const keep = (corner: number): number => {
    const known = kept.get(corner);
    if (known !== undefined) return known;
    kept.set(corner, kept.size);
    places.push(...vectorAt(mesh, 6 * corner));
    normals.push(...vectorAt(mesh, 6 * corner + 3));
    return kept.size - 1;
  };
  const found = new Map<string, [number, number, number]>();
  for (let k = 0; k < count; k += 3) {
    const [a, b, c] = [k, k + 1, k + 2].map((at) => first[corners ? corners[at]! : at]!) as [number, number, number];
    if (a === b || b === c || c === a) continue;
    found.set([a, b, c].sort().join(), facesOut(mesh, a, b, c) ? [a, b, c] : [a, c, b]);
  }
  const triangles = [...found.values()].flat().map(keep);
  return {
    places: new Float32Array(places),
    normals: new Float32Array(normals),
    triangles: new Uint32Array(triangles),
  };
}

const vectorAt = (mesh: ArrayLike<number>, at: number): Vector => [mesh[at]!, mesh[at + 1]!, mesh[at + 2]!];

/** Return for each corner the first corner of the mesh in the same cell. */
function firstCornerPerCell(mesh: ArrayLike<number>, cell: number): number[] {
  const firsts = new Map<number, number>();
  return Array.from({ length: mesh.length / 6 }, (_, corner) => {
    const [x, y, z] = vectorAt(mesh, 6 * corner).map((value) => Math.round(value / cell) + 512) as [
      number,
      number,
      number,
    ];
    const key = (x * 1024 + y) * 1024 + z;
    const first = firsts.get(key);
    if (first === undefined) firsts.set(key, corner);
    return first ?? corner;
  });
}

/** Whether the corner order of a triangle agrees with its normals. */
function facesOut(mesh: ArrayLike<number>, ...corners: [number, number, number]): boolean {
  const [p, q, r] = corners.map((corner) => vectorAt(mesh, 6 * corner)) as [Vector, Vector, Vector];
  const out = corners.reduce<Vector>((sum, corner) => plus(sum, vectorAt(mesh, 6 * corner + 3)), [0, 0, 0]);
  return dot(cross(plus(q, p, -1), plus(r, p, -1)), out) >= 0;
}
