// Stop on the page by button and key, and its display.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Actions, listen } from "../src/controls.ts";
import { Performing } from "../src/performing.ts";
import { Robot } from "../src/robot.ts";
import type { Body } from "../src/types.ts";
import { click, element, load, press, type Socket, settle, sockets } from "./page.ts";

const BODY = { hinges: ["l_elbow"] } as unknown as Body;
const servos = (state: string) => ({ state, celsius: [30], load: [0], volts: [12], errors: [0], torque: [1] });
const body = (state: string | null) => ({
  ...{ told: "body", time: 1, angles: [0.1], planned: [0.2], hottest: null, volts: null, faulty: false },
  servos: state === null ? null : servos(state),
});

interface Scene {
  window: ReturnType<typeof load>;
  robot: Robot;
  line: Socket;
  stopLine: Socket;
  calls: string[];
}

/** Open the page with a connected server. */
function begin(): Scene {
  const window = load();
  const calls: string[] = [];
  const listener = {
    opened: () => calls.push("opened"),
    changed: () => calls.push("changed"),
    moved: () => calls.push("moved"),
    heard: () => {},
  };
  const robot = new Robot(BODY, listener);
  const [line, stopLine] = sockets as [Socket, Socket];
  line.open();
  line.tell({ told: "status", state: "rest" });
  stopLine.open();
  stopLine.tell({ told: "stop_line" });
  return { window, robot, line, stopLine, calls };
}

const log = () => element("log").firstElementChild?.textContent;
const shown = () => ({
  stopped: document.body.classList.contains("stopped"),
  resume: !element("resume").hidden,
  stop: !element<HTMLButtonElement>("stop").disabled,
});

/** Names of the requested actions. */
function controlled(rests = false): { window: ReturnType<typeof load>; acts: string[] } {
  const window = load();
  const acts: string[] = [];
  const act = (name: string) => (value?: unknown) =>
    name === "rests" ? rests : void acts.push(value === undefined ? name : `${name} ${value}`);
  listen(new Proxy({}, { get: (_, name) => act(String(name)) }) as unknown as Actions);
  return { window, acts };
}

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
  assert.equal(log(), "stopped: all joints hold");
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

test("limp servos disable documents, and reports of another robot are ignored", () => {
  const { robot, line, calls } = begin();
  calls.length = 0;
  line.tell(body("limp"));
  assert.ok(robot.limp && !robot.ready);
  assert.deepEqual(calls, ["changed", "moved"]);
  line.tell(body("limp"));
  assert.deepEqual(calls, ["changed", "moved", "moved"], "what has not changed is not told");
  line.tell({ ...body("armed"), angles: [0, 0] });
  assert.ok(robot.limp);
  line.tell(body("armed"));
  assert.ok(robot.ready);
  assert.equal(robot.report?.angles[0], 0.1);
});

test("a refusal is logged, and a missing token opens its dialog", () => {
  const { window, robot, line } = begin();
  line.tell({ told: "refused", why: "a token is needed" });
  assert.equal(log(), "a token is needed");
  assert.ok(element<HTMLDialogElement>("lock").open);
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
  new Robot(BODY, { opened: () => {}, changed: () => {}, moved: () => {} });
  const line = sockets[0]!;
  line.open();
  assert.deepEqual(line.read(), [{ do: "hello", token: "kept" }]);
  line.tell({ told: "welcome" });
  line.tell(body("limp"));
  line.read();
  click(window, "arm");
  assert.equal(line.read()[0]!.token, "kept");
});

test("Escape always stops, Space only outside of text fields and buttons", () => {
  const { window, acts } = controlled();
  const places = ["text", "search", "mode", "loop", "perform", "time", "canvas"];
  const stopsBySpace = ["time", "canvas"];
  for (const place of places) {
    acts.length = 0;
    const taken = press(window, "Escape", { on: element(place) });
    assert.ok(taken, place);
    assert.deepEqual(acts, ["stop"], place);
    acts.length = 0;
    const spaced = press(window, " ", { on: element(place) });
    assert.equal(spaced, stopsBySpace.includes(place), place);
    assert.deepEqual(acts, stopsBySpace.includes(place) ? ["stop"] : [], place);
  }
  acts.length = 0;
  assert.ok(press(window, " ", { on: document.body }));
  assert.ok(press(window, "Escape", { on: document.querySelector("summary")! }));
  assert.deepEqual(acts, ["stop", "stop"]);
});

test("Escape only closes the save dialog, a menu and the tour of a robot that rests, and stops elsewhere", () => {
  for (const rests of [true, false]) {
    const { window, acts } = controlled(rests);
    const menu = Object.assign(document.createElement("button"), { role: "menuitem" });
    const list = document.createElement("div");
    list.setAttribute("role", "menu");
    list.append(menu);
    document.body.append(list);
    const pressed = (on: Element) => {
      acts.length = 0;
      const isTaken = press(window, "Escape", { on });
      assert.deepEqual(acts, isTaken ? ["stop"] : []);
      return isTaken;
    };
    assert.equal(pressed(menu), !rests);
    assert.equal(pressed(element("tour-next")), !rests);
    for (const place of [document.body, element("text"), element("canvas")]) assert.ok(pressed(place));
    const [saving, arming] = [element<HTMLDialogElement>("saving"), element<HTMLDialogElement>("arming")];
    saving.showModal();
    assert.equal(pressed(element("save-name")), !rests);
    assert.equal(pressed(document.body), !rests);
    arming.showModal();
    assert.ok(pressed(element("save-name")), "the question before arming says that Escape stops");
    saving.close();
    assert.ok(pressed(element("arm-no")));
  }
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

test("shortcuts need Ctrl, and other keys are left to the browser", () => {
  const { window, acts } = controlled();
  const shortcuts = { z: "undo", Z: "redo", y: "redo", s: "save", Enter: "perform" };
  for (const [key, act] of Object.entries(shortcuts)) {
    acts.length = 0;
    assert.ok(!press(window, key));
    assert.deepEqual(acts, []);
    assert.ok(press(window, key, { ctrlKey: true }));
    assert.deepEqual(acts, [act]);
  }
  acts.length = 0;
  const shifted = new window.KeyboardEvent("keydown", { key: "z", metaKey: true, shiftKey: true, bubbles: true });
  document.body.dispatchEvent(shifted as unknown as Event);
  assert.deepEqual(acts, ["redo"]);
  assert.ok(!press(window, "q", { ctrlKey: true }));
  assert.deepEqual(acts, ["redo"]);
});

test("each button, menu and field triggers its action", () => {
  const { window, acts } = controlled();
  const buttons = ["play", "perform", "stop", "resume", "undo", "redo", "save", "remove"];
  for (const name of buttons) {
    element<HTMLButtonElement>(name).disabled = false;
    click(window, name);
  }
  assert.deepEqual(acts.splice(0), buttons);
  for (const id of ["mode-plan", "mode-robot", "view-front", "choose-block"]) click(window, id);
  assert.deepEqual(acts.splice(0), ["show plan", "show robot", "view front", "chooseBlock"]);
  for (const on of ["true", "false"]) {
    click(window, "show-sectors");
    assert.deepEqual(acts.splice(0), [`sectors ${on}`]);
    assert.equal(element("show-sectors").getAttribute("aria-pressed"), on);
  }
  const change = (id: string, type: string) =>
    element(id).dispatchEvent(new window.Event(type, { bubbles: true }) as unknown as Event);
  element<HTMLInputElement>("time").value = "0.5";
  change("time", "input");
  element<HTMLInputElement>("loop").checked = true;
  change("loop", "change");
  element<HTMLInputElement>("voice").checked = false;
  change("voice", "change");
  assert.deepEqual(acts.splice(0), ["seek 0.5", "loop true", "voice false"]);
  element("style").append(Object.assign(document.createElement("option"), { value: "joyful" }));
  element<HTMLSelectElement>("style").value = "joyful";
  change("style", "change");
  assert.deepEqual(acts.splice(0), ["style joyful"]);
});

test("the menu lists documents when opened and opens a selected one", () => {
  const { window, acts } = controlled();
  const menu = element<HTMLSelectElement>("examples");
  const option = Object.assign(document.createElement("option"), { value: "saved:my:file.bml" });
  menu.append(option);
  menu.dispatchEvent(new window.Event("pointerdown") as unknown as Event);
  menu.value = option.value;
  const opened: unknown[] = [];
  const actions = { open: (kind: string, name: string) => opened.push(kind, name) };
  load();
  listen({ ...actions } as unknown as Actions);
  const again = element<HTMLSelectElement>("examples");
  again.append(Object.assign(document.createElement("option"), { value: "saved:my:file.bml" }));
  again.value = "saved:my:file.bml";
  again.dispatchEvent(new window.Event("change") as unknown as Event);
  assert.deepEqual(acts, ["list"]);
  assert.deepEqual(opened, ["saved", "my:file.bml"]);
  assert.equal(again.value, "");
});

test("the form passes on the token without a page load", () => {
  const { window, acts } = controlled();
  element<HTMLInputElement>("token").value = "secret";
  const event = new window.Event("submit", { bubbles: true, cancelable: true });
  element("lock").dispatchEvent(event as unknown as Event);
  assert.deepEqual(acts, ["unlock secret"]);
  assert.ok(event.defaultPrevented);
});
