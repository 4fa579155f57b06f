// Edits of the timeline: groups, edges of phases, and pasted behaviours.
import assert from "node:assert/strict";
import { test } from "node:test";
import { copyAll, paste } from "../src/tracks/clipboard.ts";
import { dependsOn, moveAll, moveOnto, stretch } from "../src/tracks/group_edits.ts";
import { nearest, type Snap } from "../src/tracks/snapping.ts";

const block = (inside: string) => `<bml id="b">${inside}</bml>`;
const times = (start: number) =>
  new Map([
    ["start", start],
    ["stroke", start + 0.5],
    ["end", start + 1],
  ]);

test("a moved group moves each behaviour once, also where one refers to another", () => {
  const text = block('<head id="a" start="1"/><head id="b2" start="a:end+0.5"/><gaze id="c" start="s:m-0.2" end="4"/>');
  const moved = moveAll(text, new Map(["a", "b2", "c"].map((id) => [id, 1])), 0.25);
  assert.equal(
    moved,
    block('<head id="a" start="1.25"/><head id="b2" start="a:end+0.5"/><gaze id="c" start="s:m+0.05" end="4.25"/>'),
  );
  assert.equal(moveAll(block('<head id="a"/>'), new Map([["a", 2]]), 1), block('<head id="a" start="3"/>'));
});

test("a behaviour that is moved onto a word takes its other points along", () => {
  const gaze = block('<gaze id="a" start="1" end="3"/>');
  const anchor = { reference: "s:m1", offset: 0 };
  const asked = new Map([
    ["start", 1],
    ["ready", 1.5],
    ["end", 3],
  ]);
  assert.equal(moveOnto(gaze, "a", "start", anchor, asked), block('<gaze id="a" start="s:m1" end="s:m1+2"/>'));
  const beat = block('<gesture id="a" start="1"/>');
  assert.equal(moveOnto(beat, "a", "stroke", anchor, times(1)), block('<gesture id="a" stroke="s:m1"/>'));
});

test("a dragged edge keeps the stroke, and follows the word to which the stroke is tied", () => {
  const tied = block('<gesture id="a" stroke="s:m1"/>');
  assert.equal(
    stretch(tied, "a", "end", 0.2, times(1), "stroke"),
    block('<gesture id="a" stroke="s:m1" end="s:m1+0.7"/>'),
  );
  const placed = block('<gesture id="a" start="1"/>');
  assert.equal(
    stretch(placed, "a", "start", -0.2, times(1), "stroke"),
    block('<gesture id="a" start="0.8" stroke="1.5"/>'),
  );
});

test("pasted behaviours refer to each other, and other references become times", () => {
  const inside =
    '<speech id="s" start="1"><sync id="m"/>x</speech><gesture id="g" stroke="s:m"/><head id="h" start="q:end"/>';
  const clip = copyAll(
    block(inside),
    ["s", "g", "h"],
    new Map([
      ["s", times(1)],
      ["h", times(3)],
    ]),
  );
  const pasted = paste(block(inside), clip, 10);
  assert.deepEqual(pasted.ids, ["s2", "g2", "h2"]);
  assert.match(pasted.text, /<speech id="s2" start="10"><sync id="m"\/>x<\/speech>/);
  assert.match(pasted.text, /<gesture id="g2" stroke="s2:m"\/>/);
  assert.match(pasted.text, /<head id="h2" start="12"\/>/);
});

test("behaviours pasted into a document with other namespaces keep theirs", () => {
  const from = '<b:bml xmlns:b="urn:b" xmlns:k="urn:kinesic" id="x"><b:gesture id="g" k:power="1" start="1"/></b:bml>';
  const clip = copyAll(from, ["g"], new Map([["g", times(1)]]));
  const { text } = paste('<bml xmlns="urn:b" id="y"></bml>', clip, 0);
  assert.match(text, /<b:gesture id="g" k:power="1" xmlns:b="urn:b" xmlns:k="urn:kinesic" start="0"\/>/);
  assert.doesNotMatch(paste(from, clip, 0).text, /g2"[^>]*xmlns/);
});

test("references lead from a behaviour to all on which it depends", () => {
  const text = block('<head id="a" start="b2:end"/><head id="b2" start="c:end"/><head id="c" start="a:end"/>');
  assert.ok(dependsOn(text, "a", new Set(["c"])));
  assert.ok(!dependsOn(text, "a", new Set(["d"])));
});

test("the nearest time within the tolerance attracts, and the first of equal ones", () => {
  const snap = (time: number, says: string): Snap => ({ time, says, target: { kind: "free" } });
  const snaps = [snap(1, "word"), snap(1, "stroke"), snap(1.5, "accent")];
  assert.equal(nearest(snaps, 1.04, 0.1)?.says, "word");
  assert.equal(nearest(snaps, 1.45, 0.1)?.says, "accent");
  assert.equal(nearest(snaps, 1.2, 0.1), undefined);
});
