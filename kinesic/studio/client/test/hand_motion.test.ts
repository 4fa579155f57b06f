// Gestures recorded from a robot that is moved by hand, and the order of key poses.
import assert from "node:assert/strict";
import { test } from "node:test";
import { toArmLengths } from "../src/arm_lengths.ts";
import { type HandSample, writeGesture } from "../src/recording/hand_motion.ts";
import { keySpans, moveKey, type Place } from "../src/toml.ts";
import { orderAt } from "../src/tracks/pose_row.ts";
import type { Body } from "../src/types.ts";

const REST: Place = [0.37, -0.4, 0.1];
const hold = (place: Place, count = 10): Place[] => Array(count).fill(place);
const line = (from: Place, to: Place, count = 20): Place[] =>
  Array.from(
    { length: count },
    (_, k) => from.map((value, axis) => value + ((to[axis]! - value) * k) / (count - 1)) as unknown as Place,
  );
const write = (samples: HandSample[]) => writeGesture("mine", samples, "recorded");
const record = (right: Place[], left: Place[] = hold(REST, right.length)): HandSample[] =>
  right.map((place, k) => ({ left: left[k]!, right: place }));

test("a recorded hand becomes the corners of its path, without the rest before and after", () => {
  const [a, b]: Place[] = [
    [0.4, 0.5, 0.6],
    [0.0, 0.5, 0.6],
  ] as const;
  const text = write(record([...hold(a!), ...line(a!, b!), ...line(b!, a!), ...hold(a!)]))!;
  const keys = keySpans(text).map(({ from, to }) => text.slice(from, to));
  assert.equal(keys.length, 3);
  assert.match(text, /^category = "metaphoric"\n\n\[\[gesture\]\]\nid = "mine"\n/);
  assert.equal(keys[1], "{ right = { at = [0.0, 0.5, 0.6] } }");
  assert.ok(
    keys.every((key) => !key.includes("left")),
    "a resting hand has no key poses",
  );
});

test("both hands that move are recorded in the same key poses", () => {
  const up: Place = [0.3, 0.6, 0.5];
  const text = write(record(line(REST, up), line(REST, up)))!;
  assert.equal(keySpans(text).length, 2);
  assert.match(text, /left = \{ at = \[0.3, 0.6, 0.5\] \}, right = \{ at = \[0.3, 0.6, 0.5\] \} \},\n\]/);
});

test("a wavering path has at most eight key poses", () => {
  const wave = Array.from({ length: 200 }, (_, k): Place => [0.3 + 0.2 * Math.sin(k / 3), 0.5 + k / 1000, 0.5]);
  const count = keySpans(write(record(wave))!).length;
  assert.equal(count, 8);
});

test("hands that hardly move are no gesture", () => {
  assert.equal(write(record(line(REST, [0.4, -0.38, 0.12]))), null);
});

test("a position is outward on its own side, in arm lengths from the origin", () => {
  const body = { gesture_origin: [0.125, 0, 1], arm_length: 0.5 } as unknown as Body;
  assert.deepEqual(toArmLengths(body, "left", [0.375, 0.25, 1.5]), [0.5, 1, 0.5]);
  assert.deepEqual(toArmLengths(body, "right", [0.375, -0.25, 1.5]), [0.5, 1, 0.5]);
});

test("a key pose is moved with its text, and everything else stays", () => {
  const text =
    "keys = [\n  { left = { at = [1] } }, # first\n  { both = { at = [2] } },\n  { right = { at = [3] } },\n]\n";
  assert.equal(
    moveKey(text, 0, 2),
    "keys = [\n  { both = { at = [2] } }, # first\n  { right = { at = [3] } },\n  { left = { at = [1] } },\n]\n",
  );
  assert.equal(moveKey(moveKey(text, 0, 2), 2, 0), text);
  assert.equal(moveKey(text, 7, 0), text);
});

test("a dragged pose is placed among the others by its time", () => {
  const times = [1, 2, 3];
  assert.deepEqual(
    [0.5, 2.4, 3.5].map((time) => orderAt(times, 1, time)),
    [0, 1, 2],
  );
  assert.equal(orderAt(times, 1, 2.9), 1);
});
