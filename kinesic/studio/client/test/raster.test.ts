// Rasterizer: covered pixels, depth test, and blending.
import assert from "node:assert/strict";
import { test } from "node:test";
import { drawFloor } from "../src/floor.ts";
import { blend, findDifference, Raster, STRIDE, type Texture } from "../src/raster.ts";
import { makeSolid, placeCorners } from "../src/solid.ts";

const SIZE = 16; // [pixels]
const RED = 0xff0000ff;
const empty: Texture = { width: SIZE, height: SIZE, pixels: new Uint32Array(SIZE * SIZE) };
type Place = [x: number, y: number];
type Colour = [red: number, green: number, blue: number];

function begun(): Raster {
  const raster = new Raster();
  raster.begin(empty);
  return raster;
}

/** Draw a counterclockwise triangle. */
function fill(raster: Raster, places: [Place, Place, Place], depth: number, colour: Colour): void {
  raster.fill(new Float32Array(places.flatMap((place) => [...place, depth, ...colour])), 0, 1, 2);
}

const drawn = (raster: Raster): number => raster.pixels.filter(Boolean).length;

test("two triangles with a common side fill each pixel once", () => {
  const [a, b, c, d]: [Place, Place, Place, Place] = [
    [1.3, 1.7],
    [2.1, 14.2],
    [14.6, 13.1],
    [12.4, 2.2],
  ];
  const [one, other, both] = [begun(), begun(), begun()];
  fill(one, [a, b, c], 0, [255, 0, 0]);
  fill(other, [a, c, d], 0, [255, 0, 0]);
  fill(both, [a, b, c], 0, [255, 0, 0]);
  fill(both, [a, c, d], 0, [255, 0, 0]);
  assert.ok(drawn(one) > 50 && drawn(other) > 50);
  assert.equal(drawn(both), drawn(one) + drawn(other));
  assert.ok(both.pixels.every((pixel) => pixel === 0 || pixel === RED));
});

test("back faces and pixels outside the picture are not drawn", () => {
  const raster = begun();
  fill(
    raster,
    [
      [1, 1],
      [14, 1],
      [1, 14],
    ],
    0,
    [255, 0, 0],
  );
  assert.equal(drawn(raster), 0);
  fill(
    raster,
    [
      [-90, -90],
      [-90, 300],
      [300, -90],
    ],
    0,
    [255, 0, 0],
  );
  assert.equal(drawn(raster), SIZE * SIZE);
});

test("the nearer triangle is visible in any drawing order", () => {
  const all: [Place, Place, Place] = [
    [-90, -90],
    [-90, 300],
    [300, -90],
  ];
  for (const depths of [
    [0.2, 0.7],
    [0.7, 0.2],
  ]) {
    const raster = begun();
    for (const depth of depths) fill(raster, all, depth, depth === 0.2 ? [255, 0, 0] : [0, 255, 0]);
    assert.ok(raster.pixels.every((pixel) => pixel === RED));
  }
});

test("colours are interpolated between corners", () => {
  const raster = begun();
  const corners = [0, 0, 0, 0, 0, 0, 0, 64, 0, 255, 0, 0, 64, 0, 0, 0, 255, 0];
  raster.fill(new Float32Array(corners), 0, 1, 2);
  const at = (x: number, y: number) => raster.pixels[y * SIZE + x]! & 0xffff;
  assert.equal(at(0, 15) & 255, Math.floor((255 * 15.5) / 64));
  assert.equal(at(15, 0) >> 8, Math.floor((255 * 15.5) / 64));
});

test("a texture is drawn with its coordinates and brightness", () => {
  const raster = begun();
  const texture = { width: 2, height: 1, pixels: new Uint32Array([0xff0000c8, 0xff00c800]) };
  const corners = [0, 0, 0, 0, 0, 0.5, 0, 2 * SIZE, 0, 0, 0, 0.5, 2 * SIZE, 0, 0, 2, 0, 0.5];
  assert.equal(corners.length, 3 * STRIDE);
  raster.fill(new Float32Array(corners), 0, 1, 2, raster.pixels, texture);
  assert.equal(raster.pixels[0], 0xff000064);
  assert.equal(raster.pixels[SIZE - 1], 0xff006400);
});

test("a translucent picture is blended over opaque and transparent pixels", () => {
  assert.equal(blend(0xff0000ff, 0xff000000, 0.4) >>> 0, 0xff000066);
  assert.equal(blend(0xff0000ff, 0, 0.4) >>> 0, 0x660000ff);
  const raster = begun();
  raster.lay(new Uint32Array(SIZE * SIZE).fill(RED, 0, 3), 1);
  assert.deepEqual([...raster.pixels.slice(0, 4)], [RED, RED, RED, 0]);
});

test("the floor shows its grid lines and ends at its border", () => {
  // Seen from straight above: 4 m across, x to the right and y up.
  const [size, half] = [400, 2];
  const view = new Float32Array([1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
  const { pixels } = drawFloor(view, [0, 0, 1], size, size);
  const at = (x: number, y: number) =>
    pixels[Math.floor((0.5 - y / 2 / half) * size) * size + Math.floor((0.5 + x / 2 / half) * size)]!;
  assert.equal(at(0.1, 0.1) & 0xffffff, 0xff0000);
  assert.ok(at(0.249, 0.1) >>> 24 > 2 * (at(0.1, 0.1) >>> 24));
  assert.ok(at(0.1, 0.1) >>> 24 > at(1.35, 0.1) >>> 24);
  assert.equal(at(1.7, 0.1), 0);
});

test("the difference of two pictures is a box or null", () => {
  const [a, b] = [new Uint32Array(60), new Uint32Array(60)];
  assert.equal(findDifference(a, b, 10), null);
  for (const [row, column] of [
    [1, 7],
    [2, 3],
    [4, 5],
  ] as const)
    b[10 * row + column] = 1;
  assert.deepEqual(findDifference(a, b, 10), { x: 3, y: 1, width: 5, height: 4 });
  assert.deepEqual(findDifference(a, new Uint32Array(60).fill(1), 10), { x: 0, y: 0, width: 10, height: 6 });
});

test("triangles behind or partly behind the camera are not drawn", () => {
  const view = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0]); // near 0.1, along -z
  const whole = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const seenAt = (third: number, others: number): number => {
    const places = new Float32Array([-1, -1, others, 1, -1, others, 0, 1, third]);
    const mesh = { places, normals: places, triangles: new Uint32Array([0, 1, 2]) };
    const solid = makeSolid(mesh, 0, null);
    placeCorners(solid, { view, eye: [0, 0, 0], frames: [whole] }, { width: SIZE, height: SIZE });
    const raster = begun();
    raster.fill(solid.corners, 0, 1, 2);
    raster.fill(solid.corners, 0, 2, 1);
    return drawn(raster);
  };
  assert.ok(seenAt(-2, -2) > 20);
  assert.equal(seenAt(2, 2), 0);
  assert.equal(seenAt(2, -2), 0);
});
