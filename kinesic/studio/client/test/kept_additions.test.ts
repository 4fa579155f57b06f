// Added movements and pauses stay near their words when gestures are chosen for a changed text.
import assert from "node:assert/strict";
import { test } from "node:test";
import { describeAdditions, keepAdditions } from "../src/text_mode/kept_additions.ts";
import { listSpoken } from "../src/text_mode/spoken.ts";
import type { Draft } from "../src/types.ts";
import { findTags } from "../src/xml.ts";

const CHOSEN = '<head id="h1" lexeme="NOD" stroke="s:w2" kinesic:reason="\'huge\' is large (accent, 0.4)"/>';
const write = (text: string, inside = "", more = "") =>
  `<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic"${more} id="said">
  <speech id="s"><text>${text}</text></speech>
${inside}</bml>
`;
const ZERO = 0.5; // [s] performance time of the block's start

/** Keep what is added to `Tea versus huge coffee.`, spoken from 1 s to 5 s of the performance. */
function keep(added: string, changed: string, { text = 'Tea <sync id="w2"/>versus huge coffee.', more = "" } = {}) {
  const former = write(text, `  ${CHOSEN}\n  ${added}\n`, more);
  const draft = {
    zero: ZERO,
    words: [
      { speech: "s", mark: "start", text: "Tea", start: 1, end: 2 },
      { speech: "s", mark: "w2", text: "versus huge coffee.", start: 2, end: 5 },
    ],
    behaviours: findTags(added)
      .filter((tag) => tag.attributes[0]?.name === "id")
      .map((tag) => ({ id: tag.attributes[0]!.value, type: tag.name })),
    syncs: [{ behaviour: "late", sync: "start", asked: 6, planned: 6 }],
  } as unknown as Draft;
  const kept = keepAdditions({ text: former, words: listSpoken(former, draft), draft }, changed);
  return { ...kept, lines: kept.text.split("\n").map((line) => line.trim()) };
}

test("a nod at a block time follows the word that was spoken then, and chosen movements are not kept", () => {
  const { text, lines, count } = keep('<head id="nod" lexeme="NOD" start="1.75"/>', write("I like tea versus coffee."));
  assert.ok(lines.includes('<speech id="s"><text>I like tea <sync id="m1"/>versus coffee.</text></speech>'));
  assert.ok(lines.includes('<head id="nod" lexeme="NOD" start="s:m1+0.25"/>'));
  assert.equal(count, 1);
  assert.ok(!text.includes('id="h1"'));
});

test("a gaze keeps its duration, a posture its pose, and an id that is used becomes another one", () => {
  const gaze = '<gaze id="look" start="0.6" end="2.6" target="left"/>';
  const posture =
    '<posture id="lean" start="s:w2" end="s:w2+2"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>';
  const { lines } = keep(
    gaze + posture,
    write('<sync id="w1"/>Tea <sync id="w7"/>versus rum.', '  <gaze id="look"/>\n'),
  );
  assert.ok(lines.includes('<gaze id="look2" target="left" start="s:w1+0.1" end="s:w1+2.1"/>'));
  assert.ok(
    lines.some((line) => line.startsWith('<posture id="lean" start="s:w7" end="s:w7+2"><pose part="WHOLEBODY"')),
  );
});

test("a movement after the speech stays after its end, and one that follows another addition keeps following it", () => {
  const smile = '<faceLexeme id="late" lexeme="smile" start="s:end+1"/>';
  const { lines } = keep(`${smile}<head id="n" lexeme="NOD" start="late:end"/>`, write("Tea."));
  assert.ok(lines.includes('<faceLexeme id="late" lexeme="smile" start="s:end+1"/>'));
  assert.ok(lines.includes('<head id="n" lexeme="NOD" start="late:end"/>'));
});

test("a movement on a word that is gone is named, and one at a time goes to the word before", () => {
  const { lines, gone, count } = keep(
    '<head id="a" lexeme="NOD" stroke="s:w2"/><head id="b" lexeme="SHAKE" start="1.5"/>',
    write("Tea and coffee."),
  );
  assert.ok(lines.includes('<head id="b" lexeme="SHAKE" start="s:start+1"/>'));
  assert.deepEqual([count, gone], [1, ["What you added for “versus” (head)"]]);
  assert.deepEqual(describeAdditions({ count, gone }), [
    "The movement that you added yourself stays.",
    "What you added for “versus” (head) is gone with its word.",
  ]);
});

test("pauses stay before their words, and are not doubled", () => {
  const text = 'Tea <break time="1s"/><sync id="w2"/>versus <break time="500ms"/>huge coffee.';
  const once = keep("", write('Tea <sync id="w2"/>versus huge <sync id="w4"/>coffee.'), { text }).text;
  assert.match(once, /Tea <break time="1s"\/><sync id="w2"\/>versus <break time="0.5s"\/>huge <sync id="w4"\/>coffee/);
  assert.equal(keep("", once, { text }).text, once);
});

test("prefixes of added movements are declared in the new document", () => {
  const nod = '<head id="nod" own:x="1" start="0.7"/>';
  assert.match(keep(nod, write("Tea."), { more: ' xmlns:own="urn:own"' }).text, /<head [^>]*xmlns:own="urn:own"/);
});
