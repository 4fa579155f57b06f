// Triangles that the processor draws into a picture in memory: without a graphics card that is sooner than by WebGL.

/** Numbers of each corner: across and down [pixels], its depth, and three that are blended between corners. */
export const STRIDE = 6;
const OPAQUE = 0xff000000;
const FAR = 2; // beyond all depths, which go from -1 to 1

/** A picture of which a triangle can take its colours. */
export interface Texture {
  width: number;
  height: number;
  pixels: Uint32Array;
}

export class Raster {
  width = 0;
  height = 0;
  /** Of each pixel, row by row: red in the lowest byte, then green, blue, and how opaque it is. */
  pixels = new Uint32Array(0);
  private depths = new Float32Array(0);
  private readonly slopes = new Float64Array(2 * STRIDE);

  /** Begins a picture on a ground that has its size. */
  begin(ground: Texture): void {
    if (this.pixels.length !== ground.pixels.length) {
      this.pixels = new Uint32Array(ground.pixels.length);
      this.depths = new Float32Array(ground.pixels.length);
    }
    this.width = ground.width;
    this.height = ground.height;
    this.pixels.set(ground.pixels);
    this.depths.fill(FAR);
  }

  /**
   * Draws a triangle where it is in front of what is drawn; one that is seen from behind is not drawn.
   * @param corners of all triangles, `STRIDE` numbers each
   * @param a b c which of them are its own, to the left as seen from outside
   * @param into colours of the pixels; the picture's own where it is left out
   * @param texture whose shares (0..1) are blended, and how light it is there; else red, green and blue (0..255) are
   */
  fill(
    corners: Float32Array,
    a: number,
    b: number,
    c: number,
    into: Uint32Array = this.pixels,
    texture?: Texture,
  ): void {
    const { width, height } = this;
    const i = STRIDE * a;
    const j = STRIDE * b;
    const k = STRIDE * c;
    const ax = corners[i]!;
    const ay = corners[i + 1]!;
    const bx = corners[j]!;
    const by = corners[j + 1]!;
    const cx = corners[k]!;
    const cy = corners[k + 1]!;
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (!(area < 0)) return;
    const first = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const last = Math.min(height - 1, Math.ceil(Math.max(ay, by, cy) - 0.5) - 1);
    if (last < first) return;
    const { slopes } = this; // of each number, from pixel to pixel across, and then of each one down
    for (let n = 2; n < STRIDE; n++) {
      const toB = corners[j + n]! - corners[i + n]!;
      const toC = corners[k + n]! - corners[i + n]!;
      slopes[n] = (toB * (cy - ay) - toC * (by - ay)) / area;
      slopes[STRIDE + n] = (toC * (bx - ax) - toB * (cx - ax)) / area;
    }
    for (let row = first; row <= last; row++) {
      const y = row + 0.5;
      const ab = ay <= y !== by <= y; // two of the three sides cross the middle of the row
      const x = ab ? crossing(ax, ay, bx, by, y) : crossing(bx, by, cx, cy, y);
      const other = ay <= y !== cy <= y ? crossing(cx, cy, ax, ay, y) : crossing(bx, by, cx, cy, y);
      const from = Math.max(0, Math.ceil(Math.min(x, other) - 0.5));
      const to = Math.min(width, Math.ceil(Math.max(x, other) - 0.5));
      if (from < to) this.fillRow(row * width + from, to - from, corners, i, from + 0.5 - ax, y - ay, into, texture);
    }
  }

  /** Fills some pixels of a row, the first of them so far from a corner of their triangle. */
  private fillRow(
    begin: number,
    count: number,
    corners: Float32Array,
    corner: number,
    right: number,
    low: number,
    into: Uint32Array,
    texture: Texture | undefined,
  ): void {
    const { slopes, depths } = this;
    const zx = slopes[2]!;
    const px = slopes[3]!;
    const qx = slopes[4]!;
    const rx = slopes[5]!;
    let z = corners[corner + 2]! + zx * right + slopes[STRIDE + 2]! * low;
    let p = corners[corner + 3]! + px * right + slopes[STRIDE + 3]! * low;
    let q = corners[corner + 4]! + qx * right + slopes[STRIDE + 4]! * low;
    let r = corners[corner + 5]! + rx * right + slopes[STRIDE + 5]! * low;
    for (let pixel = begin; pixel < begin + count; pixel++) {
      if (z < depths[pixel]!) {
        depths[pixel] = z;
        into[pixel] = texture ? sample(texture, p, q, r) : OPAQUE | (byte(r) << 16) | (byte(q) << 8) | byte(p);
      }
      z += zx;
      p += px;
      q += qx;
      r += rx;
    }
  }

  /** Lays another picture over this one, as opaque as is said (0..1), where it has a colour. */
  lay(over: Uint32Array, opacity: number): void {
    const { pixels } = this;
    for (let at = 0; at < pixels.length; at++) if (over[at]) pixels[at] = blend(over[at]!, pixels[at]!, opacity);
  }
}

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Where two pictures of a width differ; null where they are the same. */
export function differenceOf(a: Uint32Array, b: Uint32Array, width: number): Box | null {
  let [left, right, top, bottom] = [width, -1, -1, -1];
  for (let begin = 0, row = 0; begin < a.length; begin += width, row++) {
    let first = 0;
    while (first < width && a[begin + first] === b[begin + first]) first++;
    if (first === width) continue;
    let last = width - 1;
    while (a[begin + last] === b[begin + last]) last--;
    if (top < 0) top = row;
    bottom = row;
    if (first < left) left = first;
    if (last > right) right = last;
  }
  return top < 0 ? null : { x: left, y: top, width: right - left + 1, height: bottom - top + 1 };
}

/** Where a line between two places crosses a row. */
const crossing = (ax: number, ay: number, bx: number, by: number, y: number): number =>
  ax + ((y - ay) * (bx - ax)) / (by - ay);

/** A share of a colour, as far as there are such. */
const byte = (value: number): number => Math.min(Math.max(value, 0), 255);

/** The colour of a texture at a place (0..1 across and down), as light as is said (0..1). */
function sample({ width, height, pixels }: Texture, across: number, down: number, light: number): number {
  const x = Math.min(Math.max(Math.floor(across * width), 0), width - 1);
  const y = Math.min(Math.max(Math.floor(down * height), 0), height - 1);
  const colour = pixels[y * width + x]!;
  const part = (shift: number) => byte(((colour >>> shift) & 255) * light);
  return OPAQUE | (part(16) << 16) | (part(8) << 8) | part(0);
}

/** A colour over another one, of which nothing may be known to be opaque. */
export function blend(over: number, under: number, opacity: number): number {
  const left = ((under >>> 24) / 255) * (1 - opacity);
  const whole = opacity + left;
  const mixed = (shift: number) =>
    Math.round((((over >>> shift) & 255) * opacity + ((under >>> shift) & 255) * left) / whole);
  return (Math.round(255 * whole) << 24) | (mixed(16) << 16) | (mixed(8) << 8) | mixed(0);
}
