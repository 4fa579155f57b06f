// Search for gestures: answers of the server that are shown, and others that are not.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Window } from "happy-dom";
import { GestureList, readFound } from "../src/gestures.ts";
import type { Answer } from "../src/wire.ts";
import { element, load } from "./page.ts";

const GESTURES = ["conduit", "balance", "run"].map((id) => ({ id, category: "iconic", says: `It is ${id}.` }));

let window: Window;

function open(find: (words: string) => Promise<ReturnType<typeof readFound>>): {
  list: GestureList;
  shown(): string[];
} {
  window = load();
  const list = new GestureList(GESTURES, { insert: () => {}, edit: () => {}, find, picture: () => null });
  return { list, shown: () => [...document.querySelectorAll("#found b")].map((each) => each.textContent ?? "") };
}

const settle = () => new Promise((resolve) => setImmediate(resolve));

async function type(words: string): Promise<void> {
  element<HTMLInputElement>("search").value = words;
  element("search").dispatchEvent(new window.Event("input") as unknown as Event);
  await settle();
}

test("ranked gestures of the server are shown in their order, near ones marked", async () => {
  const found = [
    { ...GESTURES[1], near: false },
    { ...GESTURES[0], near: true },
  ];
  const { shown } = open(async () => found as ReturnType<typeof readFound>);
  await type("weigh two things");
  assert.deepEqual(shown(), ["balance", "conduit"]);
  assert.equal(document.querySelectorAll(".gesture.near").length, 1);
});

test("without a server the page finds gestures by itself", async () => {
  const { shown } = open(async () => null);
  await type("balan");
  assert.deepEqual(shown(), ["balance"]);
  await type("");
  assert.equal(shown().length, 3);
});

test("an answer to earlier words is not shown", async () => {
  const answers: ((found: ReturnType<typeof readFound>) => void)[] = [];
  const { shown } = open(() => new Promise((resolve) => answers.push(resolve)));
  await type("balan");
  await type("run");
  answers[0]?.([]);
  await settle();
  assert.deepEqual(shown(), ["run"]);
});

test("a gesture that was saved here is shown although the server does not know it yet", async () => {
  const { list, shown } = open(async () => []);
  list.add({ id: "my_balance", category: "iconic", says: "" });
  await type("balance");
  assert.deepEqual(shown(), ["my balance"]);
});

test("names and categories are shown in plain words, and found by them and by the words of files", async () => {
  const { list, shown } = open(async () => null);
  list.add({ id: "weigh_up", category: "metaphoric", says: "" });
  for (const words of ["weigh up", "weigh_up", "idea", "metaphoric"]) {
    await type(words);
    assert.deepEqual(shown(), ["weigh up"], words);
  }
  assert.equal(document.querySelector("#found [title]")?.textContent, "weigh up idea");
});

test("only answers to a search are read", () => {
  assert.equal(readFound(null), null);
  assert.equal(readFound({ told: "refused" } as Answer), null);
  assert.deepEqual(readFound({ told: "find", gestures: [{ id: "run" }, { id: 3 }] } as unknown as Answer), [
    { id: "run" },
  ]);
});
