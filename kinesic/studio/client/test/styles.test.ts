// Numbers of styles: what a slider shows, what a behaviour sets, and the text of an own style.
import assert from "node:assert/strict";
import { test } from "node:test";
import { changesFor, NAMES, NEUTRAL, readStyles, showNumbers, withNumbers } from "../src/styles/numbers.ts";

const JOYFUL = { ...NEUTRAL, spatial: 0.5, power: 0.3 };
const FILE = `# Wide.
spatial = 0.5  # size
power = -0.3
${NAMES.filter((name) => !["spatial", "power"].includes(name))
  .map((name) => `${name} = 0.0\n`)
  .join("")}
[head]
spatial = 0.6
`;

test("a number is that of the behaviour, or else that of its style", () => {
  const shown = showNumbers((name) => ({ power: "-0.5", tension: "0", fluidity: "x" })[name], JOYFUL);
  assert.deepEqual(shown.power, { value: -0.5, inherited: 0.3, isSet: true, differs: true });
  assert.deepEqual(shown.spatial, { value: 0.5, inherited: 0.5, isSet: false, differs: true });
  assert.deepEqual(shown.tension, { value: 0, inherited: 0, isSet: true, differs: false });
  assert.deepEqual(shown.fluidity, { value: 0, inherited: 0, isSet: false, differs: false });
});

test("a style is written as the numbers that differ from the inherited ones", () => {
  const changes = new Map(changesFor({ ...NEUTRAL, spatial: 0.5, power: -1 }, JOYFUL));
  assert.equal(changes.get("power"), -1);
  assert.equal(changes.get("spatial"), null);
  assert.equal(changes.get("tension"), null);
  assert.equal(changes.size, NAMES.length);
});

test("a saved style has its eight numbers, and every other line of the style that it is made from", () => {
  const text = withNumbers(FILE, { ...NEUTRAL, spatial: -0.25, power: 1 });
  assert.match(text, /^spatial = -0\.25 {2}# size$/m);
  assert.match(text, /^power = 1$/m);
  assert.ok(text.endsWith("[head]\nspatial = 0.6\n"));
  assert.equal(text.split("\n").length, FILE.split("\n").length);
  const added = withNumbers("[head]\nspatial = 0.6\n", NEUTRAL);
  assert.ok(NAMES.every((name) => added.slice(0, added.indexOf("[")).includes(`${name} = 0\n`)));
});

test("styles without all numbers or without text are ignored", () => {
  const style = { name: "mine", own: true, numbers: NEUTRAL, text: FILE };
  const bad = { ...style, numbers: { spatial: 1 } };
  assert.deepEqual(readStyles({ told: "styles", styles: [style, bad, { ...style, text: 5 }] }), [style]);
  assert.deepEqual(readStyles({ told: "find", styles: [style] }), []);
  assert.deepEqual(readStyles(null), []);
});
