// How finely the stage is drawn, by how long frames take.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "../src/pace.ts";

const STILL = 1000; // [ms] after all changes

function learned(software: boolean, ...frames: number[]): Pace {
  const pace = new Pace(software);
  pace.move(0);
  for (const took of frames) pace.learn(took);
  return pace;
}

test("a machine that draws in time draws all while something moves, and nothing again once it is still", () => {
  const pace = learned(false, ...Array(50).fill(6));
  assert.deepEqual(pace.quality(0), { scale: 1, full: true });
  assert.deepEqual(pace.quality(STILL), pace.quality(0));
});

test("frames that take long make the next ones coarser, never below a half, and all is fine once it is still", () => {
  const pace = learned(false, ...Array(50).fill(80));
  assert.deepEqual(pace.quality(0), { scale: 0.5, full: false });
  assert.deepEqual(pace.quality(STILL), { scale: 1, full: true });
});

test("it becomes finer again only where the finer frame would be in time", () => {
  const slow = Array(50).fill(80);
  assert.equal(learned(false, ...slow, ...Array(50).fill(10)).quality(0).scale, 0.5);
  assert.equal(learned(false, ...slow, ...Array(50).fill(2)).quality(0).scale, 1);
});

test("software draws coarse bodies while they move, and four pixels for one once they are still", () => {
  const pace = learned(true, ...Array(50).fill(6));
  assert.deepEqual(pace.quality(0), { scale: 1, full: false });
  assert.deepEqual(pace.quality(STILL), { scale: 2, full: true });
});

test("a frame of a machine that was away does not decide, frames that all take so long do", () => {
  assert.equal(learned(false, 5, 3000, 5, 5, 5, 5, 5, 5, 3000).quality(0).scale, 1);
  assert.equal(learned(false, ...Array(9).fill(3000)).quality(0).scale, 0.5);
});
