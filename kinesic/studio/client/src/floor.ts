// Floor under the robot in pictures drawn by the CPU, equal to the one of the WebGL scene.
import type { Texture } from "./raster.ts";

const FLOOR_SIZE = 1.6; // [m] half side
const GRID_SPACING = 0.25; // [m] distance of grid lines
const [FLOOR_OPACITY, LINE_OPACITY] = [0.05, 0.16] as const; // opacity of the floor, and additional opacity of its lines

const smoothly = (share: number): number => {
  const inside = Math.min(Math.max(share, 0), 1);
  return inside * inside * (3 - 2 * inside);
};

/** Closeness of a position to a grid line: 1 on it, 0 one pixel away. */
const lineAt = (place: number, step: number): number => {
  const cells = place / GRID_SPACING - 0.5;
  return 1 - Math.min(Math.abs(cells - Math.floor(cells) - 0.5) / (step / GRID_SPACING), 1);
};

/** Return the homography (3 x 3) from the canvas (-1..1) to the floor. */
function floorHomography(view: Float32Array): number[] {
  const [a, b, c, d, e, f, g, h, i] = [0, 4, 12, 1, 5, 13, 3, 7, 15].map((k) => view[k]!) as [
    ...[number, number, number, number, number, number, number, number, number],
  ];
  const of = [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f];
  of.push(d * h - e * g, b * g - a * h, a * e - b * d);
  const whole = a * of[0]! + b * of[3]! + c * of[6]!;
  return of.map((value) => value / whole);
}

/**
 * Draw the floor.
 * @param view matrix from scene to canvas
 * @param ink colour, components 0..1
 * @param width width of the picture [pixels]
 * @param height height of the picture [pixels]
 */
export function drawFloor(view: Float32Array, ink: readonly number[], width: number, height: number): Texture {
  const pixels = new Uint32Array(width * height);
  const m = floorHomography(view);
  const colour = ink.reduce((sum, share, k) => sum | (Math.round(255 * share) << (8 * k)), 0);
  const [across, down] = [2 / width, -2 / height]; // canvas units per pixel
  for (let row = 0; row < height; row++) {
    const high = 1 + (row + 0.5) * down;
    for (let column = 0; column < width; column++) {
      const right = -1 + (column + 0.5) * across;
      const t = m[6]! * right + m[7]! * high + m[8]!;
      if (t <= 0) continue; // above the horizon
      const x = (m[0]! * right + m[1]! * high + m[2]!) / t;
      const y = (m[3]! * right + m[4]! * high + m[5]!) / t;
      const away = Math.hypot(x, y);
      if (away >= FLOOR_SIZE) continue;
      const step = (place: number, k: 0 | 3) =>
        (Math.abs((m[k]! - place * m[6]!) * across) + Math.abs((m[k + 1]! - place * m[7]!) * down)) / t;
      const line = Math.max(lineAt(x, step(x, 0)), lineAt(y, step(y, 3)));
      const fade = 1 - smoothly((away / FLOOR_SIZE - 0.25) / 0.75);
      pixels[row * width + column] = (Math.round(255 * (FLOOR_OPACITY + LINE_OPACITY * line) * fade) << 24) | colour;
    }
  }
  return { width, height, pixels };
}
