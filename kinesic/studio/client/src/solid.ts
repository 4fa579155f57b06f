// Part of the body as triangles, projected and lit.
import type { Shape } from "kinesic:scene";
import type { Mesh } from "./coarse.ts";
import { STRIDE } from "./raster.ts";
import { dot, unit, type Vector } from "./vectors.ts";

export interface Solid extends Mesh {
  segment: number;
  /** Shape with the colour; a part without one shows the face. */
  shape: Shape | null;
  /** Texture coordinates of the face per corner. */
  shares: readonly number[];
  /** Projected corners, see `Raster`. */
  corners: Float32Array;
}

/** Viewpoint and segment frames of a picture. */
export interface Seen {
  view: Float32Array;
  eye: Vector;
  frames: Float32Array[];
}

const LIGHT_DIRECTION = unit([0.5, 0.45, 0.8]); // direction of the scene's light
const LAMP = unit([0.6, -0.7, 0.2]);

export const makeSolid = (mesh: Mesh, segment: number, shape: Shape | null, shares: readonly number[] = []): Solid => ({
  ...mesh,
  segment,
  shape,
  shares,
  corners: new Float32Array((STRIDE * mesh.places.length) / 3),
});

/** Project the corners to x, y and depth. */
export function placeCorners(solid: Solid, { view, frames }: Seen, size: { width: number; height: number }): void {
  const { places, corners } = solid;
  const m = times(view, frames[solid.segment]!);
  for (let from = 0, to = 0; from < places.length; from += 3, to += STRIDE) {
    const x = places[from]!;
    const y = places[from + 1]!;
    const z = places[from + 2]!;
    const depth = m[2]! * x + m[6]! * y + m[10]! * z + m[14]!;
    const away = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
    const w = depth < -away ? Number.NaN : away; // before the near plane: triangles with this corner are not drawn
    corners[to] = ((m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w + 1) * 0.5 * size.width;
    corners[to + 1] = (1 - (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w) * 0.5 * size.height;
    corners[to + 2] = depth / w;
  }
}

/** Compute the lit colour of each corner from a base colour (0..1). */
export function lightCorners(solid: Solid, { eye, frames }: Seen, paint: Vector): void {
  const { places, normals, corners } = solid;
  const f = frames[solid.segment]!;
  for (let from = 0, to = 3; from < places.length; from += 3, to += STRIDE) {
    const px = places[from]!;
    const py = places[from + 1]!;
    const pz = places[from + 2]!;
    const nx = normals[from]!;
    const ny = normals[from + 1]!;
    const nz = normals[from + 2]!;
    const x = f[0]! * nx + f[4]! * ny + f[8]! * nz;
    const y = f[1]! * nx + f[5]! * ny + f[9]! * nz;
    const z = f[2]! * nx + f[6]! * ny + f[10]! * nz;
    const ex = eye[0] - (f[0]! * px + f[4]! * py + f[8]! * pz + f[12]!);
    const ey = eye[1] - (f[1]! * px + f[5]! * py + f[9]! * pz + f[13]!);
    const ez = eye[2] - (f[2]! * px + f[6]! * py + f[10]! * pz + f[14]!);
    const long = Math.sqrt(x * x + y * y + z * z) || 1;
    const away = Math.sqrt(ex * ex + ey * ey + ez * ez);
    const sun = Math.max((x * LIGHT_DIRECTION[0] + y * LIGHT_DIRECTION[1] + z * LIGHT_DIRECTION[2]) / long, 0);
    const lamp = Math.max((x * LAMP[0] + y * LAMP[1] + z * LAMP[2]) / long, 0);
    const bare = 0.46 + (0.14 * z) / long + 0.46 * sun + 0.12 * lamp;
    const hx = LIGHT_DIRECTION[0] + ex / away;
    const hy = LIGHT_DIRECTION[1] + ey / away;
    const hz = LIGHT_DIRECTION[2] + ez / away;
    const half = Math.max((x * hx + y * hy + z * hz) / (long * Math.sqrt(hx * hx + hy * hy + hz * hz)), 0);
    const rim = 1 - Math.max((x * ex + y * ey + z * ez) / (long * away), 0);
    const gloss = 0.16 * half ** 36 + 0.1 * rim ** 3;
    for (let k = 0; k < 3; k++) corners[to + k] = Math.min(255 * (paint[k]! * bare + gloss), 255);
  }
}

/** Set texture coordinates and brightness of each corner. */
export function shareCorners({ normals, shares, corners, segment }: Solid, { frames }: Seen): void {
  const f = frames[segment]!;
  for (let k = 0, to = 3; to < corners.length; k++, to += STRIDE) {
    const [nx, ny, nz] = [normals[3 * k]!, normals[3 * k + 1]!, normals[3 * k + 2]!];
    const row = (r: 0 | 1 | 2) => f[r]! * nx + f[r + 4]! * ny + f[r + 8]! * nz;
    corners[to] = shares[2 * k]!;
    corners[to + 1] = shares[2 * k + 1]!;
    corners[to + 2] = 0.85 + 0.15 * Math.max(dot([row(0), row(1), row(2)], LIGHT_DIRECTION), 0);
  }
}

/** Return the product of two column-major matrices. */
function times(a: Float32Array, b: Float32Array): Float64Array {
  const out = new Float64Array(16);
  for (let column = 0; column < 16; column += 4)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) out[column + row]! += a[4 * k + row]! * b[column + k]!;
  return out;
}
