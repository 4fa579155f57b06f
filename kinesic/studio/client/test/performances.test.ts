// Requests to perform: sent once, withdrawn by a stop, and never counted as rest.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Performances } from "../src/performances.ts";
import { Performing } from "../src/performing.ts";
import { element, settle } from "./page.ts";
import { begin, body } from "./robot_scene.ts";

const DOCUMENT = '<bml id="b"/>';

/** A resting robot, and a page whose state and gesture choice the test sets. */
function open() {
  const scene = begin();
  const said: string[] = [];
  const page = { typed: false, playing: false, unsavedGesture: false, shown: "plan" };
  const choices: ((isComplete: boolean) => void)[] = [];
  const performing = new Performing(
    () => {},
    (text) => said.push(text),
  );
  const performances = new Performances(scene.robot, performing, {
    bml: () => DOCUMENT,
    hasTypedWords: () => page.typed,
    chooseGestures: () => new Promise((chosen) => choices.push(chosen)),
    isUnsavedGesture: () => page.unsavedGesture,
    isPlaying: () => page.playing,
    pause: () => {
      page.playing = false;
    },
    sent: () => {
      page.shown = "robot";
    },
  });
  scene.line.tell(body(null));
  scene.line.tell({ told: "status", state: "resting" });
  scene.line.read();
  scene.stopLine.read();
  const choose = async (isComplete: boolean) => {
    choices.shift()!(isComplete);
    await settle();
  };
  return { ...scene, performances, performing, page, choose, said };
}

const log = () => element("log").firstElementChild?.textContent;

test("Perform pauses the page, sends the document and shows the robot", async () => {
  const { performances, performing, page, line } = open();
  page.playing = true;
  await performances.perform();
  assert.deepEqual(line.sent, [DOCUMENT]);
  assert.deepEqual([page.playing, page.shown, performing.waits], [false, "robot", true]);
});

test("a document that cannot be sent does not change the view", async () => {
  const { performances, page, robot, said } = open();
  robot.wire.perform = () => false;
  await performances.perform();
  assert.equal(page.shown, "plan");
  assert.equal(said.at(-1), "Not performed, see Messages");
});

test("a robot that is not ready gets no document, and no gestures are chosen for it", async () => {
  const { performances, performing, page, line, stopLine } = open();
  stopLine.tell({ told: "stopped" });
  page.typed = true;
  await performances.perform();
  assert.deepEqual(line.sent, []);
  assert.ok(!performing.waits);
});

test("typed words get their gestures before the document is sent", async () => {
  const { performances, page, line, choose, said } = open();
  page.typed = true;
  void performances.perform();
  assert.equal(said.at(-1), "Getting ready …", "at once");
  await settle();
  assert.deepEqual(line.sent, []);
  await choose(true);
  assert.deepEqual(line.sent, [DOCUMENT]);
});

test("words without gestures are not performed, and the log says so", async () => {
  const { performances, page, line, choose, said } = open();
  page.typed = true;
  void performances.perform();
  await choose(false);
  assert.deepEqual(line.sent, []);
  assert.equal(said.at(-1), "Not performed, see Messages");
  assert.equal(log(), "not performed: the new words have no gestures yet");
});

test("a stop withdraws a performance whose gestures are still chosen", async () => {
  for (const end of ["stop", "withdraw"] as const) {
    const { performances, page, line, stopLine, choose } = open();
    page.typed = true;
    void performances.perform();
    performances[end]();
    await choose(true);
    assert.deepEqual(line.sent, [], end);
    assert.deepEqual(stopLine.read(), end === "stop" ? [{ do: "stop" }] : [], end);
  }
});

test("a second Perform replaces the first, so that the document is sent once", async () => {
  const { performances, page, line, choose } = open();
  page.typed = true;
  void performances.perform();
  void performances.perform();
  await choose(true);
  await choose(true);
  assert.deepEqual(line.sent, [DOCUMENT]);
});

test("a withdrawn performance stays withdrawn when Perform is pressed again", async () => {
  const { performances, page, line, choose } = open();
  page.typed = true;
  void performances.perform();
  performances.stop();
  void performances.perform();
  await choose(true);
  assert.deepEqual(line.sent, []);
  await choose(true);
  assert.deepEqual(line.sent, [DOCUMENT]);
});

test("a gesture that is not saved is not performed, and the log says so", async () => {
  const { performances, page, line } = open();
  page.unsavedGesture = true;
  await performances.perform();
  assert.deepEqual(line.sent, []);
  assert.equal(log(), "save the gesture first, so that the robot can use it");
});

test("a stop leaves the running performance to the server, a withdrawal ends it", async () => {
  const { performances, performing } = open();
  await performances.perform();
  performances.stop();
  assert.ok(performing.waits, "it may move until the server has stopped");
  performances.withdraw();
  assert.ok(!performing.waits);
});

test("a resting robot does not rest while the page plays, chooses gestures or waits for the end", async () => {
  const { performances, page, choose, robot } = open();
  assert.ok(performances.rests);
  page.playing = true;
  assert.ok(!performances.rests);
  page.playing = false;
  page.typed = true;
  void performances.perform();
  assert.ok(robot.rests && !performances.rests, "gestures are chosen");
  await choose(false);
  assert.ok(performances.rests);
  page.typed = false;
  await performances.perform();
  assert.ok(robot.rests && !performances.rests, "a document was sent");
});
