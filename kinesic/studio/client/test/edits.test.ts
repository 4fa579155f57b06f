// Edits and their undo history; random edits are undone exactly.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { addGesture, mark, remove, setAttribute, setManner, shift, tie } from "../src/edits.ts";
import { begin, change, redo, STEPS, undo } from "../src/history.ts";
import { findAttribute, findTags, tagWithId } from "../src/xml.ts";

const texts = readdirSync("../examples").map((name) => readFileSync(`../examples/${name}`, "utf8"));
const welcome = readFileSync("../../configs/bml/welcome.bml", "utf8");
const value = (text: string, id: string, name: string) => findAttribute(tagWithId(text, id)!, name)?.value;

function randomly(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

function edited(text: string, random: () => number): string {
  const ids = findTags(text).flatMap((tag) => tag.attributes.filter((a) => a.name === "id").map((a) => a.value));
  const id = ids.slice(1)[Math.floor(random() * (ids.length - 1))] ?? "none"; // not the document itself
  const time = random() * 9;
  switch (Math.floor(random() * 7)) {
    case 0:
      return tie(text, id, "stroke", { time });
    case 1:
      return tie(text, id, "stroke", { speech: "s", mark: "m1" });
    case 2:
      return shift(text, id, random() < 0.5 ? "start" : "stroke", time - 4.5, time);
    case 3:
      return setAttribute(text, id, "lexeme", random() < 0.2 ? null : `a & "b" ${time}`);
    case 4:
      return remove(text, id);
    case 5:
      return addGesture(text, "Open_Palm", time);
    default:
      return mark(text, "s", "start", Math.floor(random() * 5)).text;
  }
}

test("200 random edits are undone and redone exactly, for 1000 seeds", () => {
  for (let seed = 0; seed < 1000; seed++) {
    const random = randomly(seed);
    let history = begin([welcome, ...texts][seed % (texts.length + 1)]!);
    const first = history.present;
    let made = 0;
    for (let k = 0; k < STEPS; k++) {
      const after = change(history, edited(history.present, random));
      made += after === history ? 0 : 1;
      history = after;
    }
    assert.ok(made > 5);
    const last = history.present;
    for (let k = 0; k < STEPS; k++) history = undo(history);
    assert.equal(history.present, first);
    for (let k = 0; k < STEPS; k++) history = redo(history);
    assert.equal(history.present, last);
  }
});

test("at most 200 steps are kept, and a change clears the redo history", () => {
  let history = begin(0);
  for (let k = 1; k <= 300; k++) history = change(history, k);
  assert.equal(history.past.length, STEPS);
  history = change(undo(history), -1);
  assert.equal(redo(history), history);
});

test("tying a stroke to a mark removes other pinned points and changes nothing else", () => {
  const after = tie(welcome, "wave", "stroke", { speech: "s", mark: "large" });
  assert.equal(after, welcome.replace('strokeStart="s:hello"/>', 'stroke="s:large"/>').replace("  stroke", " stroke"));
  assert.equal(value(after, "wave", "strokeStart"), undefined);
});

test("a shift keeps its reference", () => {
  assert.equal(value(shift(welcome, "nod", "stroke", -0.4, 2), "nod", "stroke"), "s:welcome");
  assert.equal(value(shift(welcome, "nod", "stroke", 0.25, 2), "nod", "stroke"), "s:welcome+0.65");
  assert.equal(value(shift(welcome, "large", "stroke", -0.25, 2), "large", "stroke"), "s:large-0.25");
  assert.equal(value(shift(texts[0]!, "g", "start", 0.5, 0.3), "g", "start"), "0.8");
});

test("a manner is added in the kinesic namespace, changed in place, and removed", () => {
  const plain = texts[0]!;
  const strong = setManner(plain, "g", "power", 0.5);
  assert.equal(strong, plain.replace('start="0.3"', 'start="0.3" kinesic:power="0.5"'));
  assert.equal(setManner(strong, "g", "power", null), plain);
  assert.equal(value(setManner(texts[2]!, "shy", "spatial", 0), "shy", "k:spatial"), "0");
});

test("a word gets one mark", () => {
  const after = mark(welcome, "s", "large", 1);
  assert.ok(after.text.includes('<sync id="large"/>large <sync id="m1"/>gestures, and'));
  assert.equal(mark(welcome, "s", "large", 0).mark, "large");
  assert.equal(mark(welcome, "none", "large", 3).text, welcome);
});

test("comments and quotes are parsed, and values are escapeXml", () => {
  const text = `<bml id="b"><!-- <gesture id="g"/> --><gesture id='g' lexeme="a&amp;b"/></bml>`;
  assert.equal(value(text, "g", "lexeme"), "a&b");
  const after = setAttribute(text, "g", "lexeme", `<"'&`);
  assert.equal(value(after, "g", "lexeme"), `<"'&`);
  assert.equal(remove(text, "g"), `<bml id="b"><!-- <gesture id="g"/> --></bml>`);
});

test("hostile text takes linear time, and a hostile name stays a value", () => {
  const begun = performance.now();
  for (const piece of ["<!", "<!--", "<![CDATA[", "<?", "<a ", '<a b="', "<a b=' "]) findTags(piece.repeat(100_000));
  findTags(`<a${" ".repeat(300_000)}<`);
  assert.ok(performance.now() - begun < 5000); // quadratic time would take a hundred times as long
  const text = addGesture('<bml id="b"></bml>', `x" start="9"/><speech id="s`, 0);
  assert.deepEqual(
    findTags(text).map((tag) => tag.name),
    ["bml", "gesture", "bml"],
  );
});
