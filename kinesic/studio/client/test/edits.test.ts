// Edits and their undo history; random edits are undone exactly.
import assert from "node:assert/strict";
import { test } from "node:test";
import { addGesture, mark, remove, setAttribute, setKinesicAttribute, shift, tie } from "../src/edits.ts";
import { begin, change, redo, STEPS, undo } from "../src/history.ts";
import { findAttribute, findTags, tagWithId } from "../src/xml.ts";
import { edited, randomly, texts, welcome } from "./random_edits.ts";

const [oneGesture, manners] = [texts[1]!, texts[3]!];
const value = (text: string, id: string, name: string) => findAttribute(tagWithId(text, id)!, name)?.value;

test("200 random edits are undone and redone exactly, for 1000 seeds", () => {
  for (let seed = 0; seed < 1000; seed++) {
    const random = randomly(seed);
    let history = begin(texts[seed % texts.length]!);
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
  assert.equal(value(shift(oneGesture, "g", "start", 0.5, 0.3), "g", "start"), "0.8");
});

test("an expressivity number is added in the kinesic namespace, changed in place, and removed", () => {
  const plain = oneGesture;
  const strong = setKinesicAttribute(plain, "g", "power", 0.5);
  const declared = plain.replace('id="one"', 'id="one" xmlns:kinesic="urn:kinesic"');
  assert.equal(strong, declared.replace('start="0.3"', 'start="0.3" kinesic:power="0.5"'));
  assert.equal(setKinesicAttribute(strong, "g", "power", null), declared);
  assert.equal(setKinesicAttribute(plain, "g", "power", null), plain);
  assert.equal(value(setKinesicAttribute(manners, "shy", "spatial", 0), "shy", "k:spatial"), "0");
});

test("an attribute with an undeclared prefix is changed, and its prefix declared", () => {
  const bare = '<bml id="b"><gesture id="g" kinesic:style="shy"/></bml>';
  const after = setKinesicAttribute(bare, "g", "style", "proud");
  assert.equal(after, '<bml id="b" xmlns:kinesic="urn:kinesic"><gesture id="g" kinesic:style="proud"/></bml>');
});

test("another meaning of the prefix is left alone", () => {
  const taken = '<bml id="b" xmlns:kinesic="urn:other"><gesture id="g"/></bml>';
  const after = setKinesicAttribute(taken, "g", "power", 1);
  assert.ok(after.includes('xmlns:kinesic2="urn:kinesic"') && after.includes('<gesture id="g" kinesic2:power="1"/>'));
});

test("a new id is not one that something refers to", () => {
  const text = '<bml id="b"><speech id="s"><text>one two</text></speech><gesture id="g" stroke="s:m1+0.25"/></bml>';
  assert.equal(mark(text, "s", "start", 1).mark, "m2");
  const waiting = '<bml id="b"><gesture id="g" start="offer:end"/></bml>';
  assert.ok(addGesture(waiting, "offer", 0).includes('id="offer2"'));
  const same = '<bml id="b"><gesture id="g" lexeme="offer"/></bml>';
  assert.ok(addGesture(same, "offer", 0).includes('id="offer"'));
});

test("new elements have the prefix of the document, and an empty document is opened for them", () => {
  const prefixed = '<b:bml xmlns:b="x" id="b"><b:speech id="s"><b:text>one two</b:text></b:speech></b:bml>';
  assert.ok(addGesture(prefixed, "offer", 0).includes('<b:gesture id="offer"'));
  assert.ok(mark(prefixed, "s", "start", 1).text.includes('one <b:sync id="m1"/>two'));
  assert.equal(
    addGesture('<bml id="b" />', "offer", 0),
    '<bml id="b">\n  <gesture id="offer" lexeme="offer" start="0"/>\n</bml>',
  );
});

test("no mark is put into a comment", () => {
  const text = '<bml id="b"><speech id="s"><text>one <!-- a > b --> two</text></speech></bml>';
  assert.ok(mark(text, "s", "start", 1).text.includes('<!-- a > b --> <sync id="m1"/>two'));
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
