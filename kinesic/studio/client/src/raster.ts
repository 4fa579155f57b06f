// Triangle rasterizer on the CPU, faster than software WebGL without a graphics card.

/** Numbers per corner: x and y [pixels], depth, and three interpolated values. */
export const STRIDE = 6;
const OPAQUE = 0xff000000;
const MAX_DEPTH = 2; // beyond all depths -1..1

/** Picture that serves as a texture. */
export interface Texture {
  width: number;
  height: number;
  pixels: Uint32Array;
}

export class Raster {
  width = 0;
  height = 0;
  /** RGBA per pixel, row by row, red in the lowest byte. */
  pixels = new Uint32Array(0);
  private depths = new Float32Array(0);
  private readonly slopes = new Float64Array(2 * STRIDE);

  /** Start a picture with a background of its size. */
  begin(ground: Texture): void {
    if (this.pixels.length !== ground.pixels.length) {
      this.pixels = new Uint32Array(ground.pixels.length);
      this.depths = new Float32Array(ground.pixels.length);
    }
    this.width = ground.width;
    this.height = ground.height;
    this.pixels.set(ground.pixels);
    this.depths.fill(MAX_DEPTH);
  }

  /**
   * Draw a triangle with depth test and back-face culling.
   * @param corners corners of all triangles, `STRIDE` numbers each
   * @param a b c corner indices, counterclockwise as seen from outside
   * @param into pixels to draw into; default: the picture
   * @param texture texture for interpolated coordinates (0..1) and brightness; default: interpolated RGB (0..255)
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
    const { slopes } = this; // of each value, per pixel across, then per pixel down
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

  /** Fill pixels of a row; the first is at an offset from a corner of the triangle. */
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
        into[pixel] = texture
          ? sample(texture, p, q, r)
          : OPAQUE | (clampToByte(r) << 16) | (clampToByte(q) << 8) | clampToByte(p);
      }
      z += zx;
      p += px;
      q += qx;
      r += rx;
    }
  }

  /** Blend another picture over this one with an opacity (0..1), where it has colour. */
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

/** Return the bounding box of differing pixels; null if the pictures are equal. */
export function findDifference(a: Uint32Array, b: Uint32Array, width: number): Box | null {
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

/** Return the crossing of a line with a row. */
const crossing = (ax: number, ay: number, bx: number, by: number, y: number): number =>
  ax + ((y - ay) * (bx - ax)) / (by - ay);

/** Clamp a colour component to 0..255. */
const clampToByte = (value: number): number => Math.min(Math.max(value, 0), 255);

/** Return the texture's colour at coordinates (0..1) with a brightness (0..1). */
function sample({ width, height, pixels }: Texture, across: number, down: number, light: number): number {
  const x = Math.min(Math.max(Math.floor(across * width), 0), width - 1);
  const y = Math.min(Math.max(Math.floor(down * height), 0), height - 1);
  const colour = pixels[y * width + x]!;
  const part = (shift: number) => clampToByte(((colour >>> shift) & 255) * light);
  return OPAQUE | (part(16) << 16) | (part(8) << 8) | part(0);
}

/** Blend a colour over another one, which may be transparent. */
export function blend(over: number, under: number, opacity: number): number {
  const left = ((under >>> 24) / 255) * (1 - opacity);
  const whole = opacity + left;
  const mixed = (shift: number) =>
    Math.round((((over >>> shift) & 255) * opacity + ((under >>> shift) & 255) * left) / whole);
  return (Math.round(255 * whole) << 24) | (mixed(16) << 16) | (mixed(8) << 8) | mixed(0);
}
