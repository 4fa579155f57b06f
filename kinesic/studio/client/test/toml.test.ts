// Edits of gesture files change only the named value; random edits are undone exactly.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { copyKey, formatPosition, keySpans, mirror, removeKey, rename, setHand } from "../src/toml.ts";

const folder = "../../configs/gestures/";
const gestures = readdirSync(folder).flatMap((name) =>
  readFileSync(folder + name, "utf8")
    .split(/^(?=\[)/m)
    .filter((part) => part.startsWith("[[gesture]]")),
);
const own = gestures.find((text) => text.includes('id = "conduit"'))!;

test("keys of every gesture are found, and mirroring twice restores a gesture", () => {
  assert.ok(gestures.length > 200);
  for (const text of gestures) {
    const spans = keySpans(text);
    assert.ok(spans.length > 0, text);
    for (const { from, to } of spans) assert.match(text.slice(from, to), /^\{[\s\S]*\}$/);
    assert.equal(mirror(mirror(text)), text);
    const copied = copyKey(text, spans.length - 1);
    assert.equal(keySpans(copied).length, spans.length + 1);
    assert.equal(removeKey(copied, spans.length), text);
  }
});

test("a value is changed in place, added, and removed", () => {
  assert.equal(
    setHand(own, 1, "both", "at", formatPosition([0.5, -0.1, 0.66666])),
    own.replace("[0.18, 0.24, 0.76]", "[0.5, -0.1, 0.667]"),
  );
  assert.equal(setHand(own, 1, "left", "palm", '"up"'), own);
  const touched = setHand(own, 0, "both", "touch", '"chest"');
  assert.ok(touched.includes('openness = 0.2, touch = "chest" }'));
  assert.equal(setHand(touched, 0, "both", "touch", null), own);
  assert.equal(formatPosition([1, -0.00001, 0.25]), "[1.0, 0.0, 0.25]");
});

test("brackets in comments and strings are skipped, and the last key stays", () => {
  const odd = 'keys = [\n  # ] not { this\n  { left = { at = [0, 0, 0], palm = "up" } }, # "}\n]\n';
  assert.equal(keySpans(odd).length, 1);
  assert.equal(removeKey(odd, 0), odd);
  assert.ok(mirror(odd).includes("{ right = { at"));
  assert.equal(rename(own, "mine"), own.replace('"conduit"', '"mine"'));
});
