// Recording of telemetry: its length, the report at a time, and the exported table.
import assert from "node:assert/strict";
import { test } from "node:test";
import { MAX_DURATION, Recording } from "../src/recording/recording.ts";
import type { BodyReport, ServoPlace } from "../src/types.ts";

const report = (time: number, more: Partial<BodyReport> = {}): BodyReport => ({
  time,
  angles: [Math.PI / 2, 0],
  planned: [Math.PI, 0],
  hottest: null,
  volts: null,
  faulty: false,
  servos: null,
  ...more,
});
const recorded = (...times: number[]) => {
  const recording = new Recording();
  for (const time of times) recording.add(report(time));
  return recording;
};

test("only the last two minutes are kept", () => {
  const recording = recorded(0, 1, MAX_DURATION, MAX_DURATION + 1);
  assert.equal(recording.count, 3);
  assert.equal(recording.begin, 1);
  assert.equal(recording.end, MAX_DURATION + 1);
});

test("a clock that goes back begins a new recording", () => {
  assert.equal(recorded(50, 51, 2).count, 1);
});

test("the report at a time is the last one before it", () => {
  const recording = recorded(1, 2, 3);
  assert.deepEqual(
    [0.5, 1, 2.9, 3, 99].map((time) => recording.at(time)?.time),
    [1, 1, 2, 3, 3],
  );
  assert.equal(new Recording().at(1), null);
});

test("the table has a column per joint and servo value, and empty cells for missing ones", () => {
  const recording = new Recording();
  const state = { load: [0.25], celsius: [40], volts: [12], errors: [0], torque: [1] };
  recording.add(report(1.5, { angles: [null as unknown as number, 0], servos: { state: "armed", ...state } }));
  recording.add(report(2));
  const places = [{ bus: "body", id: 11, hinge: "elbow", model: "m", hottest: 80 }] as ServoPlace[];
  assert.equal(
    recording.table(["elbow", "wrist"], places),
    "time_s,elbow_planned_deg,wrist_planned_deg,elbow_measured_deg,wrist_measured_deg," +
      "elbow_body_11_load,elbow_body_11_celsius,elbow_body_11_volts,elbow_body_11_errors,elbow_body_11_torque\n" +
      "1.500,180.00,0.00,,0.00,0.25,40,12,0,1\n" +
      "2.000,180.00,0.00,90.00,0.00,,,,,\n",
  );
});
