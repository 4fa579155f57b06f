// Text mode: words with their gestures, and edits that show another gesture at a word.
import assert from "node:assert/strict";
import { test } from "node:test";
import { readAlternatives } from "../src/text_mode/alternatives.ts";
import { describePending, measure } from "../src/text_mode/pending.ts";
import { choose, isWritten } from "../src/text_mode/replacing.ts";
import { listSpoken, locate, spokenText } from "../src/text_mode/spoken.ts";
import { pauseBefore, wordAt } from "../src/tracks/pauses.ts";
import type { Draft } from "../src/types.ts";
import type { Answer } from "../src/wire.ts";

const BML = `<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="said">
  <speech id="s"><text>There were <sync id="w3"/>three big <sync id="w5"/>boxes.</text></speech>
  <gesture id="g1" lexeme="count_three" mode="LEFT_HAND" stroke="s:w3+0.07" kinesic:reason="'three' is a number (picture, 0.68)"/>
  <gesture id="g2" lexeme="beat" start="1.9"/>
  <pointing id="p" target="left" stroke="s:w5"/>
  <head id="h1" lexeme="NOD" stroke="s:w5"/>
</bml>`;
const draft = {
  words: [
    { speech: "s", mark: "start", text: "There were", start: 0, end: 1 },
    { speech: "s", mark: "w3", text: "three big", start: 1, end: 2 },
    { speech: "s", mark: "w5", text: "boxes.", start: 2, end: 3 },
  ],
  behaviours: [
    ["s", "speech"],
    ["g1", "gesture"],
    ["g2", "gesture"],
    ["p", "pointing"],
    ["h1", "head"],
  ].map(([id, type]) => ({ id, type, outcome: "realised", why: "" })),
  syncs: [{ behaviour: "g2", sync: "stroke", asked: 1.9, planned: 1.9 }],
} as unknown as Draft;
const words = listSpoken(BML, draft);
const names = (index: number) => words[index]!.gestures.map(({ name }) => name);

test("gestures belong to the word of their mark, or to the word at their stroke time", () => {
  assert.deepEqual(
    words.map(({ text }) => text),
    ["There", "were", "three", "big", "boxes."],
  );
  assert.deepEqual([0, 1, 2, 3, 4].map(names), [[], [], ["count_three"], ["beat"], ["to left"]]);
});

test("reason and intent of a gesture are read without the score", () => {
  assert.equal(words[2]!.gestures[0]!.reason, "'three' is a number");
  assert.equal(words[2]!.gestures[0]!.intent, "picture");
  assert.equal(words[3]!.gestures[0]!.reason, "");
});

test("a word is located in the text of its speech", () => {
  const { text, at } = locate(words, words[3]!);
  assert.equal(text, "There were three big boxes.");
  assert.equal(text.slice(at, at + 3), "big");
  assert.equal(spokenText(words), text);
});

test("another gesture keeps its id and place, and loses the hand and the reason of the former one", () => {
  const text = choose(BML, words[2]!, words[2]!.gestures[0]!, { id: "conduct", why: "found for 'three'" });
  const line = text.split("\n").find((each) => each.includes('id="g1"'))!;
  assert.equal(
    line.trim(),
    '<gesture id="g1" lexeme="conduct" stroke="s:w3+0.07" kinesic:reason="chosen: found for &apos;three&apos;"/>',
  );
  assert.equal(text.split("\n").filter((each) => !BML.includes(each)).length, 1);
});

test("a first gesture of a word without a mark gets a new mark", () => {
  const text = choose(BML, words[1]!, null, { id: "beat", why: "stresses the word" });
  assert.match(text, /There <sync id="(m1)"\/>were /);
  assert.match(text, /<gesture id="g" lexeme="beat" stroke="s:m1" kinesic:reason="chosen: stresses the word"\/>/);
  const first = choose(BML, words[0]!, null, { id: "beat", why: "x" });
  assert.match(first, /stroke="s:start"/);
});

test("a gesture replaces a pointing gesture", () => {
  const text = choose(BML, words[4]!, words[4]!.gestures[0]!, { id: "square", why: "x" });
  assert.ok(!text.includes("<pointing"));
  assert.match(text, /lexeme="square" stroke="s:w5"/);
});

test("alternatives are read without scores, and those without an id are left out", () => {
  const gestures = [{ id: "tiny_low", why: "'tiny' is small (0.72)" }, { why: "x" }, { id: "beat", why: "stress (2)" }];
  assert.deepEqual(
    readAlternatives({ told: "alternatives", gestures } as unknown as Answer).map(({ why }) => why),
    ["'tiny' is small", "stress"],
  );
  assert.deepEqual(readAlternatives({ told: "refused" } as Answer), []);
});

test("only blocks written for a text are replaced by another text", () => {
  assert.ok(isWritten(BML));
  assert.ok(!isWritten(BML.replace('id="said"', 'id="mine"')));
  assert.ok(!isWritten(""));
});

test("typed words are counted, and those that the performance lacks", () => {
  assert.equal(measure(Array(53).fill("word").join(" \n ")), "53 words, about 18 s");
  assert.equal(measure("Tea"), "1 word, about 1 s");
  assert.equal(measure(" \n"), "");
  assert.equal(describePending("There were  boxes.", "There were\nboxes."), "");
  assert.equal(describePending("", "There were boxes."), "");
  assert.equal(
    describePending("There were no boxes.", "There were boxes."),
    "1 new word is not yet in the performance",
  );
  assert.equal(
    describePending("There were two, two boxes.", "There were boxes."),
    "2 new words are not yet in the performance",
  );
  assert.equal(describePending("boxes.", "There were boxes."), "The changed text is not yet in the performance");
});

test("a pause is written before a word and its mark", () => {
  assert.match(pauseBefore(BML, words[2]!, 1.5) ?? "", /were <break time="1.5s"\/><sync id="w3"\/>three/);
  assert.match(pauseBefore(BML, words[3]!, 2) ?? "", /three <break time="2s"\/>big/);
  assert.match(pauseBefore(BML, words[0]!, 1) ?? "", /<text><break time="1s"\/>There/);
  assert.equal(pauseBefore(BML, { ...words[0]!, speech: "other" }, 1), null);
});

test("the word at a time is spoken then, or next in the same speech", () => {
  assert.deepEqual(
    [-0.1, 0.1, 1.2, 2.9, 2.995].map((time) => wordAt(words, time)?.text),
    [undefined, "There", "three", "boxes.", undefined],
  );
});
