// Positions and directions in the scene, and their projection to the canvas.

export type Vector = readonly [number, number, number];

export const plus = (a: Vector, b: Vector, scale = 1): Vector => [
  a[0] + scale * b[0],
  a[1] + scale * b[1],
  a[2] + scale * b[2],
];
export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = ([a, b, c]: Vector, [x, y, z]: Vector): Vector => [b * z - c * y, c * x - a * z, a * y - b * x];
export const unit = (a: Vector): Vector => plus([0, 0, 0], a, 1 / (Math.hypot(...a) || 1));

/** Project a position to x and y (-1..1) and depth. */
export function project(view: Float32Array, [x, y, z]: Vector): { x: number; y: number; w: number } {
  const row = (k: number) => view[k]! * x + view[k + 4]! * y + view[k + 8]! * z + view[k + 12]!;
  return { x: row(0) / row(3), y: row(1) / row(3), w: row(3) };
}

/** Return the position at a canvas point (-1..1) with the depth of another position. */
export function unproject(view: Float32Array, eye: Vector, x: number, y: number, like: Vector): Vector {
  // rows of the matrix are the camera axes: right and up scaled by the lens, and the viewing direction
  const row = (k: number): Vector => [view[k]!, view[k + 4]!, view[k + 8]!];
  const right = row(0);
  const up = row(1);
  const ahead = row(3);
  const depth = dot(ahead, plus(like, eye, -1));
  const across = plus(eye, ahead, depth / dot(ahead, ahead));
  return plus(plus(across, right, (x * depth) / dot(right, right)), up, (y * depth) / dot(up, up));
}
