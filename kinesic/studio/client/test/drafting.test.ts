// Requests of plans: a plan is shown only for the present document.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Drafting } from "../src/drafting.ts";
import type { Answer } from "../src/wire.ts";
import { load, settle } from "./page.ts";

const FAULT = { line: 1, column: 1 };

/** Requests of plans that the test answers; answers are faults, which carry their text. */
function open() {
  load();
  const shown: string[] = [];
  const waiting: boolean[] = [];
  const answers: ((answer: Answer) => void)[] = [];
  Object.assign(window, { setTimeout: globalThis.setTimeout });
  const drafting = new Drafting(() => new Promise((answered) => answers.push(answered)), {
    drafted: () => shown.push("draft"),
    failed: ({ text }) => shown.push(text),
    waiting: (on) => waiting.push(on),
  });
  const answer = async (index: number, text: string) => {
    answers[index]!({ told: "plan", error: { ...FAULT, text } });
    await settle();
  };
  return { drafting, shown, waiting, answers, answer };
}

test("a plan of the former document is not shown after a change", async () => {
  const { drafting, shown, answers, answer } = open();
  void drafting.now();
  drafting.later();
  await answer(0, "former");
  assert.deepEqual(shown, []);
  mock.timers.tick(200);
  assert.equal(answers.length, 2);
  await answer(1, "present");
  assert.deepEqual(shown, ["present"]);
});

test("a change hides the waiting message only when its own plan has arrived", async () => {
  const { drafting, waiting, answer } = open();
  drafting.later();
  mock.timers.tick(200);
  mock.timers.tick(500);
  assert.deepEqual(waiting, [true]);
  drafting.later();
  await answer(0, "former");
  assert.deepEqual(waiting, [true]);
  mock.timers.tick(200);
  await answer(1, "present");
  assert.deepEqual(waiting, [true, false]);
});

test("a single change is planned at once, and changes during its planning together after a pause", async () => {
  const { drafting, shown, answers, answer } = open();
  drafting.soon();
  assert.equal(answers.length, 1);
  drafting.soon();
  drafting.soon();
  assert.equal(answers.length, 1);
  await answer(0, "first");
  mock.timers.tick(200);
  assert.equal(answers.length, 2);
  drafting.soon();
  assert.equal(answers.length, 2);
  mock.timers.tick(200);
  await answer(1, "second");
  await answer(2, "third");
  assert.deepEqual(shown, ["third"]);
  drafting.soon();
  assert.equal(answers.length, 4);
});

test("a plan that is requested at once replaces the one after a pause in typing", () => {
  const { drafting, answers } = open();
  drafting.later();
  void drafting.now();
  mock.timers.tick(500);
  assert.equal(answers.length, 1);
});
