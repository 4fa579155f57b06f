// The chosen word of text mode with its alternatives: marks while a choice is planned, and the selection of the timeline.
import assert from "node:assert/strict";
import { test } from "node:test";
import { TextMode } from "../src/text_mode/text_mode.ts";
import type { About, Draft } from "../src/types.ts";
import type { Wire } from "../src/wire.ts";
import { click, element, load, settle } from "./page.ts";

const BML = `<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="said">
  <speech id="s"><text><sync id="w0"/>three <sync id="w1"/>boxes</text></speech>
  <gesture id="g1" lexeme="count_three" stroke="s:w0"/>
  <gesture id="g2" lexeme="beat" stroke="s:w1"/>
  <gesture id="g3" lexeme="square" stroke="s:w1"/>
</bml>`;
const draft = {
  words: [
    { speech: "s", mark: "w0", text: "three", start: 0, end: 1 },
    { speech: "s", mark: "w1", text: "boxes", start: 1, end: 2 },
  ],
  behaviours: ["g1", "g2", "g3"].map((id) => ({ id, type: "gesture", outcome: "realised", why: "" })),
  syncs: [],
} as unknown as Draft;
const ALTERNATIVES = ["count_three", "beat", "conduct"].map((id) => ({ id, why: "fits", category: "", says: "" }));

/** Text mode with a planned document; the server answers with the same alternatives for each word. */
function open() {
  const window = load();
  Object.assign(globalThis, { Element: window.Element });
  window.HTMLElement.prototype.scrollIntoView = () => {};
  const page = { text: BML, edits: 0, selected: [] as (string | null)[] };
  const wire = { ask: async () => ({ told: "alternatives", gestures: ALTERNATIVES }) } as unknown as Wire;
  const ignore = () => {};
  const mode = new TextMode({ templates: [] } as unknown as About, wire, {
    ...{ text: () => page.text, rewrite: ignore, open: ignore, typed: ignore },
    ...{ changed: () => false, picture: () => null },
    edit: (text) => {
      page.text = text;
      page.edits += 1;
    },
    select: (id) => page.selected.push(id),
  });
  mode.show(draft);
  const press = async (selector: string) => {
    const button = document.querySelector(selector)!;
    button.dispatchEvent(new window.MouseEvent("click", { bubbles: true }) as unknown as Event);
    await settle();
  };
  return { window, mode, page, press };
}

const pressed = (list: string) =>
  [...document.querySelectorAll(`#${list} [aria-pressed=true] b, #${list} > [aria-pressed=true]`)].map(
    (each) => each.firstChild!.textContent,
  );
const title = () => element("alternatives-title").textContent;

test("a chosen gesture is marked at once, and its plan ends the mark", async () => {
  const { mode, press, page } = open();
  await press("[data-spoken='0']");
  assert.deepEqual([title(), pressed("alternatives-list")], ["“three”: count three", ["count three"]]);
  await press("[data-gesture=conduct]");
  assert.equal(page.edits, 1);
  assert.deepEqual([title(), pressed("alternatives-list")], ["“three”: conduct, planning …", ["conduct"]]);
  mode.show(draft);
  await settle();
  assert.deepEqual([title(), pressed("alternatives-list")], ["“three”: conduct", ["conduct"]]);
});

test("a gesture of the whole list goes to the word that a person has chosen, else nowhere", async () => {
  const { mode, press, page } = open();
  assert.ok(!mode.place("balance"));
  mode.follow("g1");
  assert.ok(!mode.place("balance"), "a selection in the timeline is no chosen word");
  assert.equal(page.edits, 0);
  await press("[data-spoken='1']");
  assert.ok(mode.place("balance"));
  assert.match(page.text, /<gesture id="g2" lexeme="balance" stroke="s:w1"/);
  assert.equal(title(), "“boxes”: balance, planning …");
});

test("a removed gesture is shown as removed at once", async () => {
  const { window, press } = open();
  await press("[data-spoken='0']");
  click(window, "alternatives-remove");
  assert.deepEqual([title(), pressed("alternatives-list")], ["“three”: no gesture, planning …", []]);
});

test("a gesture selected in the timeline chooses its word and is the one to be replaced", async () => {
  const { mode, page, press } = open();
  mode.follow("g3");
  await settle();
  assert.deepEqual([title(), pressed("spoken")], ["“boxes”: square", ["boxes"]]);
  mode.follow("g2");
  await settle();
  assert.deepEqual([title(), pressed("alternatives-list")], ["“boxes”: beat", ["beat"]]);
  assert.deepEqual(page.selected, [], "the timeline keeps its selection and time");
  mode.follow("g3");
  await settle();
  await press("[data-gesture=conduct]");
  assert.match(page.text, /id="g2" lexeme="beat"/);
  assert.match(page.text, /id="g3" lexeme="conduct"/);
});

test("an ended selection releases the word unless a person chose it", async () => {
  const { mode, press } = open();
  mode.follow("g1");
  assert.equal(mode.wordAt(1.5)?.text, "boxes", "pauses stay at the time of the slider");
  mode.follow(null);
  assert.deepEqual([element("alternatives").hidden, pressed("spoken")], [true, []]);
  await press("[data-spoken='0']");
  mode.follow("g1");
  mode.follow(null);
  assert.deepEqual([element("alternatives").hidden, pressed("spoken")], [false, ["three"]]);
  assert.equal(mode.wordAt(1.5)?.text, "three");
});
