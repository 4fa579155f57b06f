// Clock of a running performance: started and ended by feedback, kept by reports of the robot.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Performing } from "../src/performing.ts";
import { load } from "./page.ts";

/** A performance of block b, on a page whose clock and frames the test drives. */
function begin(bml = '<bml id="b"/>') {
  load();
  const clock = { now: 5000 }; // [ms]
  let frames: (() => void)[] = [];
  Object.assign(globalThis, {
    performance: { now: () => clock.now },
    requestAnimationFrame: (callback: () => void) => frames.push(callback),
  });
  const shown: number[] = [];
  const said: string[] = [];
  const performing = new Performing(
    (time) => shown.push(time),
    (text) => said.push(text),
  );
  performing.begin(bml);
  const hear = (about: string, time: number | null = 1, kind = "blockProgress") =>
    performing.hear({ kind, about, time, text: "" });
  const frame = () => {
    const due = frames;
    frames = [];
    for (const each of due) each();
    return { shown: shown.at(-1), said: said.at(-1), waiting: frames.length };
  };
  return { performing, clock, shown, said, hear, frame };
}

test("the time of a performance begins with the feedback of its start", () => {
  const { performing, clock, hear, frame } = begin();
  assert.ok(!performing.runs);
  hear("b:start", 10);
  assert.ok(performing.runs);
  clock.now += 125;
  assert.deepEqual(frame(), { shown: 0.125, said: "Performing 0.1 s", waiting: 1 });
});

test("reports of the robot correct the clock, which runs on for at most 0.2 s without one", () => {
  const { performing, clock, hear, frame } = begin();
  hear("b:start", 10);
  performing.reported(12);
  clock.now += 50;
  assert.ok(Math.abs(frame().shown! - 2.05) < 1e-9);
  clock.now += 5000;
  assert.ok(Math.abs(frame().shown! - 2.2) < 1e-9);
});

test("a report from before the start shows time 0", () => {
  const { performing, hear, frame } = begin();
  hear("b:start", 10);
  performing.reported(9);
  assert.equal(frame().shown, 0);
});

test("the end of the block is shown once and ends the clock", () => {
  const { performing, shown, said, hear, frame } = begin();
  hear("b:start", 10);
  hear("b:end", 13);
  assert.deepEqual([performing.runs, performing.waits], [false, false]);
  assert.deepEqual([shown.at(-1), said.at(-1)], [Number.POSITIVE_INFINITY, "Finished"]);
  const count = shown.length;
  assert.equal(frame().waiting, 0);
  assert.equal(shown.length, count);
});

test("a stop ends the clock without calling the performance finished", () => {
  const { performing, said, hear, frame } = begin();
  hear("b:start", 10);
  performing.end();
  assert.deepEqual([performing.runs, said.at(-1), frame().waiting], [false, "", 0]);
  hear("b:end", 11);
  assert.equal(said.at(-1), "", "feedback of a stopped block changes nothing");
});

test("the page shows at once that the robot gets ready, until it moves", () => {
  const { performing, said, hear, frame } = begin();
  assert.equal(said.at(-1), "Getting ready …");
  hear("b:start", 10);
  assert.equal(frame().said, "Performing 0.0 s");
  performing.begin("<bml/>");
  assert.equal(said.at(-1), "Sent to the robot", "the start of a block without an id is not reported");
});

test("a refused block is not performed, and other warnings change nothing", () => {
  const { performing, said } = begin();
  const warn = (about: string, text: string) => performing.hear({ kind: "warningFeedback", about, time: null, text });
  warn("g", "rule limp: the servos have no torque");
  warn("b", "partly: the robot lacks fingers");
  assert.equal(said.at(-1), "Getting ready …");
  warn("b", "rule limp: the servos have no torque");
  assert.equal(said.at(-1), "Not performed, see Messages");
  assert.ok(performing.waits, "an earlier block of this id may still move the robot");
});

test("a refusal of the same block does not hide the clock of the running one", () => {
  const { performing, said, hear } = begin();
  hear("b:start", 10);
  performing.hear({ kind: "warningFeedback", about: "b", time: null, text: "a block of this id plays already" });
  assert.ok(performing.runs);
  assert.equal(said.at(-1), "Getting ready …", "the next frame shows the clock");
});

test("feedback of other blocks, kinds and without a time is ignored", () => {
  const { performing, hear } = begin();
  hear("other:start");
  hear("b:start", 10, "syncPointProgress");
  hear("b:start", null);
  assert.ok(!performing.runs);
  hear("b:start", 10);
  hear("other:end");
  hear("b:end", null);
  assert.ok(performing.runs && performing.waits);
});

test("feedback is not taken for a block without an id", () => {
  const { performing, hear } = begin("<bml/>");
  hear(":start");
  assert.ok(!performing.runs);
  assert.ok(performing.waits);
});

test("a new document forgets the clock and the message of the former one", () => {
  const { performing, said, hear } = begin();
  hear("b:start", 10);
  hear("b:end", 11);
  performing.begin('<bml id="c"/>');
  assert.deepEqual([performing.runs, performing.waits, said.at(-1)], [false, true, "Getting ready …"]);
});

test("a block that starts again keeps a single clock", () => {
  const { hear, frame } = begin();
  hear("b:start", 10);
  hear("b:start", 11);
  assert.equal(frame().waiting, 1);
});
