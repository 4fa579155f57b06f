// When Escape may close a dialog without a stop: only if surely nothing moves.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Performing } from "../src/performing.ts";
import { click, element, load, settle } from "./page.ts";
import { begin, body } from "./robot_scene.ts";

test("a block that is refused because the servos hold makes Resume appear", () => {
  const { line } = begin();
  line.tell({ told: "status", state: "resting" });
  const warn = (text: string) =>
    line.tell(`<warningFeedback xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">${text}</warningFeedback>`);
  line.read();
  warn("a stroke is late");
  assert.deepEqual(line.read(), []);
  warn("rule stopped: the servos hold after an interruption; resume first");
  assert.deepEqual(line.read(), [{ do: "status" }]);
  assert.ok(element("resume").hidden);
  line.tell({ told: "status", state: "stopped" });
  assert.ok(!element("resume").hidden);
});

test("the robot rests only if the server said so, nothing has begun since, and no servo has or gets torque", async () => {
  const { window, robot, line, stopLine } = begin();
  const rests = (state: string) => {
    line.tell({ told: "status", state });
    return robot.rests;
  };
  assert.ok(!rests("resting"), "no report has come yet");
  line.tell(body(null));
  assert.ok(robot.rests);
  assert.ok(!rests("playing") && !rests("stopped") && rests("resting"));
  line.tell('<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b:start" globalTime="1"/>');
  assert.ok(!robot.rests);
  for (const state of ["armed", "arming", "releasing", "ended", "limp"]) {
    line.tell(body(state));
    assert.equal(rests("resting"), state === "limp", state);
  }
  for (const refuses of [true, false]) {
    line.read();
    click(window, "arm");
    line.tell({ told: "confirm", id: line.read()[0]!.id, code: "1", servos: 1, lasts: 30 });
    await settle();
    click(window, "arm-yes");
    assert.ok(!robot.rests, "torque is requested");
    line.tell(body("limp"));
    assert.ok(!robot.rests);
    line.tell({ told: refuses ? "refused" : "armed", why: "no", id: line.read()[0]!.id });
    await settle();
    assert.equal(robot.rests, refuses);
  }
  line.tell(body("armed"));
  line.tell(body("limp"));
  assert.ok(robot.rests);
  stopLine.tell({ told: "stopped" });
  assert.ok(!robot.rests);
  robot.resume();
  robot.askState();
  assert.deepEqual(line.read().at(-1), { do: "status" });
  assert.ok(rests("resting"));
  line.close();
  assert.ok(!robot.rests);
});

test("servos that never had torque rest from the first report on", () => {
  const { robot, line } = begin();
  line.tell({ told: "status", state: "resting" });
  line.tell(body("limp"));
  assert.ok(robot.rests);
});

test("a document waits from its request until its end or a stop", () => {
  load();
  const performing = new Performing(
    () => {},
    () => {},
  );
  const hear = (about: string) => performing.hear({ kind: "blockProgress", about, time: 1, text: "" });
  assert.ok(!performing.waits);
  performing.begin('<bml id="b"/>');
  hear("other:end");
  assert.ok(performing.waits);
  hear("b:end");
  assert.ok(!performing.waits);
  performing.begin("<bml/>");
  assert.ok(performing.waits, "a block without id may still move");
  performing.end();
  assert.ok(!performing.waits);
});
