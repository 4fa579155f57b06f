// The floor under the robot as the scene draws it, for pictures that the processor makes.
import type { Texture } from "./raster.ts";

const REACH = 1.6; // [m] of it
const CELL = 0.25; // [m] between two lines
const [PLAIN, LINE] = [0.05, 0.16] as const; // how opaque it is, and how much more so its lines are

const smoothly = (share: number): number => {
  const inside = Math.min(Math.max(share, 0), 1);
  return inside * inside * (3 - 2 * inside);
};

/** How near to a line a place is: 1 on it, 0 a pixel away. */
const lineAt = (place: number, step: number): number => {
  const cells = place / CELL - 0.5;
  return 1 - Math.min(Math.abs(cells - Math.floor(cells) - 0.5) / (step / CELL), 1);
};

/** From the canvas (-1..1) to the floor, times how far away that is: three rows of three. */
function toFloor(view: Float32Array): number[] {
  const [a, b, c, d, e, f, g, h, i] = [0, 4, 12, 1, 5, 13, 3, 7, 15].map((k) => view[k]!) as [
    ...[number, number, number, number, number, number, number, number, number],
  ];
  const of = [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f];
  of.push(d * h - e * g, b * g - a * h, a * e - b * d);
  const whole = a * of[0]! + b * of[3]! + c * of[6]!;
  return of.map((value) => value / whole);
}

/**
 * Draws the floor alone.
 * @param view from the picture's space to the canvas
 * @param ink its colour, each share 0..1
 * @param width of the picture [pixels]
 * @param height of the picture [pixels]
 */
export function floorOf(view: Float32Array, ink: readonly number[], width: number, height: number): Texture {
  const pixels = new Uint32Array(width * height);
  const m = toFloor(view);
  const colour = ink.reduce((sum, share, k) => sum | (Math.round(255 * share) << (8 * k)), 0);
  const [across, down] = [2 / width, -2 / height]; // of the canvas, from pixel to pixel
  for (let row = 0; row < height; row++) {
    const high = 1 + (row + 0.5) * down;
    for (let column = 0; column < width; column++) {
      const right = -1 + (column + 0.5) * across;
      const t = m[6]! * right + m[7]! * high + m[8]!;
      if (t <= 0) continue; // above the horizon
      const x = (m[0]! * right + m[1]! * high + m[2]!) / t;
      const y = (m[3]! * right + m[4]! * high + m[5]!) / t;
      const away = Math.hypot(x, y);
      if (away >= REACH) continue;
      const step = (place: number, k: 0 | 3) =>
        (Math.abs((m[k]! - place * m[6]!) * across) + Math.abs((m[k + 1]! - place * m[7]!) * down)) / t;
      const line = Math.max(lineAt(x, step(x, 0)), lineAt(y, step(y, 3)));
      const fade = 1 - smoothly((away / REACH - 0.25) / 0.75);
      pixels[row * width + column] = (Math.round(255 * (PLAIN + LINE * line) * fade) << 24) | colour;
    }
  }
  return { width, height, pixels };
}
