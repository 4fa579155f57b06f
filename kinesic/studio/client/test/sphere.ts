// Sphere in the form of shapes: six numbers per corner, position and normal.

/** Triangles of a sphere around the origin; half of them are wound the wrong way. */
export function sphere(radius: number, count: number): number[] {
  const place = (i: number, j: number): number[] => {
    const [around, high] = [(2 * Math.PI * i) / count, Math.PI * (j / count - 0.5)];
    const out = [Math.cos(around) * Math.cos(high), Math.sin(around) * Math.cos(high), Math.sin(high)];
    return [...out.map((value) => radius * value), ...out];
  };
  return Array.from({ length: count * count }, (_, k) => {
    const [i, j] = [k % count, Math.floor(k / count)];
    const [a, b, c] = [place(i, j), place(i + 1, j), place(i, j + 1)];
    return k % 2 ? [a, b, c].flat() : [a, c, b].flat();
  }).flat();
}
