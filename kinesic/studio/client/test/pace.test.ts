// Drawing quality of the stage by frame times.
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

test("a fast machine draws in full quality during motion, and nothing again at rest", () => {
  const pace = learned(false, ...Array(50).fill(6));
  assert.deepEqual(pace.quality(0), { scale: 1, full: true });
  assert.deepEqual(pace.quality(STILL), pace.quality(0));
});

test("slow frames reduce the resolution to at least a half until motion ends", () => {
  const pace = learned(false, ...Array(50).fill(80));
  assert.deepEqual(pace.quality(0), { scale: 0.5, full: false });
  assert.deepEqual(pace.quality(STILL), { scale: 1, full: true });
});

test("the resolution increases only if the finer frame would be fast enough", () => {
  const slow = Array(50).fill(80);
  assert.equal(learned(false, ...slow, ...Array(50).fill(10)).quality(0).scale, 0.5);
  assert.equal(learned(false, ...slow, ...Array(50).fill(2)).quality(0).scale, 1);
});

test("software draws coarse meshes during motion, and four samples per pixel at rest", () => {
  const pace = learned(true, ...Array(50).fill(6));
  assert.deepEqual(pace.quality(0), { scale: 1, full: false });
  assert.deepEqual(pace.quality(STILL), { scale: 2, full: true });
});

test("one interrupted frame does not reduce the quality, repeated slow frames do", () => {
  assert.equal(learned(false, 5, 3000, 5, 5, 5, 5, 5, 5, 3000).quality(0).scale, 1);
  assert.equal(learned(false, ...Array(9).fill(3000)).quality(0).scale, 0.5);
});
