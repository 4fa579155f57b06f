// What is left of a body where software draws it while it moves.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

type Triple = [number, number, number];
interface Shapes {
  box(at: Triple, half: Triple): number[];
  coarsened(mesh: number[], begin: number, corners: number[], cell: number): number[];
}

// A script of pages, no module; `npm test` runs in the folder of the client.
const script = readFileSync(join(process.cwd(), "../../report/templates/shapes.js"), "utf8");
const { box, coarsened } = new Function(`${script}; return { box, coarsened };`)() as Shapes;

const BEGIN = 7; // the first vertex of the mesh among those of all
const CELL = 0.05; // [m]
const ball = sphere(0.2, 40);

/** Two thousand triangles, half of which run the wrong way round. */
function sphere(radius: number, count: number): number[] {
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

const countOf = (mesh: number[]): number => mesh.length / 6;
const corners = (mesh: number[]): number[] => Array.from({ length: countOf(mesh) }, (_, k) => BEGIN + k);

test("fewer triangles are left, each corner a vertex of the mesh", () => {
  const left = coarsened(ball, BEGIN, corners(ball), CELL);
  assert.ok(left.length > 0 && left.length < countOf(ball) / 4);
  assert.ok(left.every((corner) => corner >= BEGIN && corner < BEGIN + countOf(ball)));
});

test("all of them are seen from outside, however they ran: none is taken for its back", () => {
  for (const mesh of [ball, box([0.1, 0, 0.2], [0.1, 0.2, 0.3])]) {
    const left = coarsened(mesh, BEGIN, corners(mesh), CELL);
    assert.ok(left.length > 0);
    for (let k = 0; k < left.length; k += 3) {
      const [a, b, c] = left
        .slice(k, k + 3)
        .map((corner) => mesh.slice(6 * (corner - BEGIN), 6 * (corner - BEGIN) + 6));
      const [u, v] = [b!, c!].map((end) => [0, 1, 2].map((axis) => end[axis]! - a![axis]!)) as [Triple, Triple];
      const way = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const out = [3, 4, 5].map((axis) => a![axis]! + b![axis]! + c![axis]!);
      assert.ok(way.reduce((sum, value, axis) => sum + value * out[axis]!, 0) >= 0);
    }
  }
});

test("two parts of one mesh have the same corners where they meet", () => {
  const half = countOf(ball) / 2;
  const parts = [corners(ball).slice(0, half), corners(ball).slice(half)];
  const whole = new Set(coarsened(ball, BEGIN, corners(ball), CELL));
  for (const part of parts) for (const corner of coarsened(ball, BEGIN, part, CELL)) assert.ok(whole.has(corner));
});
