// Simplified mesh.
import assert from "node:assert/strict";
import { test } from "node:test";
import { cellSize, coarsen, type Mesh } from "../src/coarse.ts";
import { cross, dot, plus, type Vector } from "../src/vectors.ts";
import { sphere } from "./sphere.ts";

const CELL = 0.05; // [m]
const NOTHING = 1e-8; // [m3] zero volume in single precision
const ball = sphere(0.2, 40);
const countOf = (mesh: readonly number[]): number => mesh.length / 6;
const vector = (of: ArrayLike<number>, k: number): Vector => [of[3 * k]!, of[3 * k + 1]!, of[3 * k + 2]!];
const key = (place: Vector): string => place.map((value) => value.toFixed(5)).join();
const placesOf = ({ places }: Mesh): string[] =>
  Array.from({ length: places.length / 3 }, (_, k) => key(vector(places, k)));

test("the result has fewer triangles with corners and normals of the mesh", () => {
  const left = coarsen(ball, undefined, CELL);
  assert.ok(left.triangles.length > 0 && left.triangles.length < countOf(ball) / 4);
  assert.equal(left.places.length, left.normals.length);
  assert.equal(Math.max(...left.triangles), left.places.length / 3 - 1);
  const all = new Set(Array.from({ length: countOf(ball) }, (_, k) => key(vector(ball, 2 * k))));
  assert.ok(placesOf(left).every((place) => all.has(place)));
  for (let k = 0; k < left.places.length / 3; k++)
    assert.ok(dot(vector(left.places, k), vector(left.normals, k)) > 0.199);
});

test("all triangles face outwards, whatever their winding was", () => {
  const { places, normals, triangles } = coarsen(ball, undefined, CELL);
  for (let k = 0; k < triangles.length; k += 3) {
    const corners = [...triangles.slice(k, k + 3)];
    const [a, b, c] = corners.map((corner) => vector(places, corner)) as [Vector, Vector, Vector];
    const out = corners.reduce<Vector>((sum, corner) => plus(sum, vector(normals, corner)), [0, 0, 0]);
    assert.ok(dot(cross(plus(b, a, -1), plus(c, a, -1)), out) >= -NOTHING);
  }
});

test("two parts of one mesh share corners at their border", () => {
  const all = Array.from({ length: countOf(ball) }, (_, k) => k);
  const whole = new Set(placesOf(coarsen(ball, all, CELL)));
  for (const part of [all.slice(0, all.length / 2), all.slice(all.length / 2)])
    for (const place of placesOf(coarsen(ball, part, CELL))) assert.ok(whole.has(place));
});

test("the cell size depends on the size of the part", () => {
  assert.equal(cellSize(ball), 0.02);
  const tip = sphere(0.006, 40);
  const { places, triangles } = coarsen(tip, undefined, cellSize(tip));
  assert.ok(triangles.length >= 3 * 50);
  for (const axis of [0, 1, 2]) {
    const along = places.filter((_, k) => k % 3 === axis);
    assert.ok(Math.max(...along) - Math.min(...along) > 0.75 * 0.012);
  }
});
