// Stop on the page, its display, and the state of the connected robot.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Robot } from "../src/robot.ts";
import { click, element, settle, sockets } from "./page.ts";
import { BODY, begin, body } from "./robot_scene.ts";

const log = () => element("log").firstElementChild?.textContent;
const shown = () => ({
  stopped: document.body.classList.contains("stopped"),
  resume: !element("resume").hidden,
  stop: !element<HTMLButtonElement>("stop").disabled,
});

test("the connected page watches the robot and lists its servos", async () => {
  const { robot, line, calls } = begin();
  assert.ok(robot.ready);
  assert.deepEqual(calls.slice(0, 2), ["opened", "changed"]);
  assert.deepEqual(shown(), { stopped: false, resume: false, stop: true });
  assert.equal(document.body.dataset.state, "open");
  assert.equal(element("state").textContent, "connected");
  const asked = line.read();
  assert.deepEqual(asked.slice(0, 3), [{ do: "status" }, { do: "watch", rate: 20 }, { do: "status" }]);
  assert.deepEqual(asked[3], { do: "servos", id: 1 });
  const place = { bus: "body", id: 3, hinge: "l_elbow", model: "XM430", hottest: 80 };
  line.tell({ told: "servos", id: 1, servos: [place] });
  await settle();
  assert.deepEqual(robot.places, [place]);
  line.close();
  assert.ok(!robot.ready);
  assert.equal(shown().stop, false);
  assert.equal(element("state").textContent, "no server");
  assert.equal(calls.filter((call) => call === "opened").length, 1);
});

test("a connection that is lost before the servos are listed leaves none", async () => {
  const { robot, line } = begin();
  line.close();
  await settle();
  assert.deepEqual(robot.places, []);
});

test("a report is not shown while an earlier one is looked at", () => {
  const { robot, line } = begin();
  line.tell(body("limp"));
  const drawn: unknown[] = [];
  robot.live.show = (report) => drawn.push(report.time);
  robot.look(robot.report);
  line.tell({ ...body("limp"), time: 2 });
  assert.deepEqual(drawn, [1]);
  assert.deepEqual([robot.report?.time, robot.shown?.time], [2, 1]);
  robot.look(null);
  line.tell({ ...body("limp"), time: 3 });
  assert.deepEqual(drawn, [1, 2, 3]);
});

test("stop is sent at once, shown when the server has stopped, and ended by resume", () => {
  const { robot, line, stopLine, calls } = begin();
  line.read();
  stopLine.read();
  robot.stop();
  assert.deepEqual(stopLine.read(), [{ do: "stop" }]);
  assert.ok(!robot.stopped, "it is not said before it is so");
  calls.length = 0;
  stopLine.tell({ told: "stopped" });
  assert.deepEqual(shown(), { stopped: true, resume: true, stop: true });
  assert.ok(robot.stopped && !robot.ready);
  assert.deepEqual(calls, ["changed"]);
  assert.equal(log(), "stopped: the robot holds its posture");
  robot.resume();
  assert.deepEqual(line.read(), [{ do: "resume" }]);
  assert.deepEqual(shown(), { stopped: false, resume: false, stop: true });
  assert.ok(robot.ready);
});

test("a failed stop and a stopped server are shown with the reason", () => {
  const { robot, line } = begin();
  line.tell({ told: "failed", why: "servo 3 does not answer" });
  assert.ok(robot.stopped);
  assert.equal(log(), "servo 3 does not answer");
  line.tell({ told: "status", state: "playing" });
  assert.ok(!robot.stopped);
  line.tell({ told: "status", state: "stopped" });
  assert.ok(robot.stopped && shown().resume);
});

test("a stop without a connection asks to cut the power", () => {
  const { robot, line, stopLine } = begin();
  line.close();
  stopLine.close();
  robot.stop();
  assert.equal(log(), "no server: use the switch that cuts its power");
});

test("a sent stop does not mention the power", () => {
  const { robot } = begin();
  robot.stop();
  assert.notEqual(log(), "no server: use the switch that cuts its power");
});

test("a stop closes the arming dialog", async () => {
  const { window, robot, line } = begin();
  line.tell(body("limp"));
  line.read();
  click(window, "arm");
  line.tell({ told: "confirm", id: line.read()[0]!.id, code: "1", servos: 1, lasts: 30 });
  await settle();
  assert.ok(element<HTMLDialogElement>("arming").open);
  robot.stop();
  assert.ok(!element<HTMLDialogElement>("arming").open);
});

test("servos without torque disable documents, and reports of another robot are ignored", () => {
  const { robot, line, calls } = begin();
  calls.length = 0;
  line.tell(body("limp"));
  assert.ok(robot.isTorqueOff && !robot.ready);
  assert.deepEqual(calls, ["changed", "moved"]);
  line.tell(body("limp"));
  assert.deepEqual(calls, ["changed", "moved", "moved"], "what has not changed is not told");
  line.tell({ ...body("armed"), angles: [0, 0] });
  assert.ok(robot.isTorqueOff);
  assert.equal(robot.report?.servos?.state, "limp");
  line.tell(body("armed"));
  assert.ok(robot.ready);
  assert.equal(robot.report?.angles[0], 0.1);
});

test("a refusal is logged, and a missing token opens its dialog", () => {
  const { window, robot, line } = begin();
  line.tell({ told: "refused", why: "a token is needed" });
  assert.equal(log(), "a token is needed");
  assert.ok(element<HTMLDialogElement>("lock").open);
  assert.equal(element("state").textContent, "token needed");
  assert.ok(!robot.ready && !shown().stop);
  line.read();
  robot.unlock("secret");
  assert.equal(window.sessionStorage.getItem("token"), "secret");
  assert.deepEqual(line.read(), [{ do: "hello", token: "secret" }]);
  line.tell({ told: "welcome" });
  assert.ok(robot.ready && !element<HTMLDialogElement>("lock").open);
});

test("a stored token is sent to the server and with the arming request", () => {
  const { window } = begin();
  window.sessionStorage.setItem("token", "kept");
  sockets.length = 0;
  new Robot(BODY, { opened: () => {}, changed: () => {}, moved: () => {}, told: () => {} });
  const line = sockets[0]!;
  line.open();
  assert.deepEqual(line.read(), [{ do: "hello", token: "kept" }]);
  line.tell({ told: "welcome" });
  line.tell(body("limp"));
  line.read();
  click(window, "arm");
  assert.equal(line.read()[0]!.token, "kept");
});
