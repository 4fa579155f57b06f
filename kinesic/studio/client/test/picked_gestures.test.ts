// Picked gestures stay on their words when gestures are chosen for a changed text.
import assert from "node:assert/strict";
import { test } from "node:test";
import { findWord, setKinesicAttribute } from "../src/edits.ts";
import { alignWords } from "../src/text_mode/alignment.ts";
import { describeKept, keepPicked, markEdited } from "../src/text_mode/picked_gestures.ts";
import { findShown } from "../src/text_mode/spoken.ts";
import { readWords } from "../src/text_mode/written_words.ts";

const write = (text: string, ...gestures: string[]) =>
  `<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="said">
  <speech id="s"><text>${text}</text></speech>
${gestures.map((gesture) => `  <gesture ${gesture}/>`).join("\n")}
</bml>`;
const PICKED =
  'id="g7" lexeme="balance" mode="LEFT_HAND" stroke="s:w2+0.1" kinesic:style="shy" kinesic:reason="chosen: found"';
const CHOSEN = 'id="g1" lexeme="big" mode="RIGHT_HAND" stroke="s:w3" kinesic:reason="\'huge\' is large (picture, 0.8)"';
const FORMER = write('Tea <sync id="w2"/>versus <sync id="w3"/>huge coffee.', PICKED, CHOSEN);

const shownIn = (text: string) => findShown(text, readWords(text));
const keep = (changed: string) => keepPicked(FORMER, shownIn(FORMER), changed);

test("words are read with the mark before them, and only marks and blanks divide them", () => {
  const words = readWords(
    write('One <emphasis level="strong">two</emphasis>, <sync id="m"/>&amp; <break time="1s"/>three'),
  );
  assert.deepEqual(
    words.map(({ mark, index, text }) => `${mark} ${index} ${text}`),
    ["start 0 One", "start 1 two,", "m 0 &", "m 1 three"],
  );
  assert.deepEqual(readWords("<bml/>"), []);
});

test("a word behind an emphasised word with a comma is found at its own place", () => {
  const text = write('One <emphasis level="strong">two</emphasis>, three');
  assert.equal(text.slice(findWord(text, "s", "start", 2)!.at).slice(0, 5), "three");
});

test("words are aligned by the longest common order, without case and punctuation", () => {
  const align = (former: string, present: string) => [...alignWords(former.split(" "), present.split(" "))].sort();
  assert.deepEqual(align("a b c", "a x b, C"), [
    [0, 0],
    [1, 2],
    [2, 3],
  ]);
  assert.deepEqual(align("to be or not to be", "not to be"), [
    [3, 0],
    [4, 1],
    [5, 2],
  ]);
  assert.deepEqual(align("a b c d", "b a d"), [
    [1, 0],
    [3, 2],
  ]);
});

test("a picked gesture replaces the chosen one on its word, with its hand, style and reason", () => {
  const changed = write(
    'I weigh tea <sync id="w4"/>versus coffee.',
    'id="g1" lexeme="beat" amount="0.4" stroke="s:w4" kinesic:power="0.5" kinesic:reason="stress (emphasis, 0.5)"',
  );
  const { text, count, gone } = keep(changed);
  assert.deepEqual([count, gone], [1, []]);
  const [gesture, ...others] = text.match(/<gesture[^>]*>/g)!;
  assert.deepEqual(others, []);
  assert.equal(
    gesture,
    '<gesture id="g1" lexeme="balance" stroke="s:w4" mode="LEFT_HAND" kinesic:style="shy" kinesic:reason="chosen: found"/>',
  );
});

test("a picked gesture gets a mark on a word without one, and gestures of other words stay", () => {
  const changed = write(
    '<sync id="w1"/>Tea versus coffee.',
    'id="g1" lexeme="offer" stroke="s:w1" kinesic:reason="x (offer, 1)"',
  );
  const words = shownIn(keep(changed).text);
  assert.deepEqual(
    words.map(({ gestures }) => gestures.map(({ name, isPicked }) => `${name} ${isPicked}`)),
    [["offer false"], ["balance true"], []],
  );
});

test("a chosen gesture that a person has changed is picked, and keeps its intent", () => {
  const styled = setKinesicAttribute(FORMER, "g1", "style", "shy");
  const marked = markEdited(FORMER, styled);
  assert.match(marked, /<gesture id="g1" [^>]*reason="chosen: [^"]*\(picture, 0.8\)" kinesic:style="shy"/);
  const [, , huge] = shownIn(marked);
  assert.deepEqual(
    huge!.gestures.map(({ isPicked, intent, reason }) => [isPicked, intent, reason]),
    [[true, "picture", "'huge' is large"]],
  );
  assert.equal(markEdited(FORMER, FORMER.replace("Tea", "Tee")), FORMER.replace("Tea", "Tee"));
  assert.equal(markEdited(marked, setKinesicAttribute(marked, "g1", "style", null)).match(/chosen:/g)!.length, 2);
  const kept = keepPicked(marked, shownIn(marked), write("A huge house.")).text;
  assert.match(kept, /lexeme="big" stroke="s:m1" [^>]*kinesic:style="shy"/);
});

test("a picked gesture whose word is gone is named", () => {
  const changed = write("Tea and coffee.");
  const kept = keep(changed);
  assert.deepEqual([kept.text, kept.count, kept.gone], [changed, 0, ["versus"]]);
  assert.deepEqual(describeKept(kept), ["The gesture that you picked for “versus” is gone with its word."]);
  assert.deepEqual(describeKept({ count: 2, gone: [] }), ["The 2 gestures that you picked stay."]);
});
