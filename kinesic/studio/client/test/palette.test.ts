// Palette: every entry is added at a time, with a new id.
import assert from "node:assert/strict";
import { test } from "node:test";
import { addEntry, addSpeech, PALETTE } from "../src/palette.ts";
import { findTags } from "../src/xml.ts";

const DOCUMENT = '<bml id="b">\n  <gesture id="g" lexeme="offer" start="nod:end"/>\n</bml>';

test("every entry is one behaviour at the time, and the rest of the document stays", () => {
  for (const [group, entries] of Object.entries(PALETTE))
    for (const { label } of entries) {
      const added = addEntry(DOCUMENT, `${group}/${label}`, 1.25);
      assert.ok(added?.text.startsWith(DOCUMENT.slice(0, -"</bml>".length)));
      const tag = findTags(added.text).find((each) => each.attributes.some(({ value }) => value === added.id));
      assert.equal(tag?.attributes.find(({ name }) => name === "start")?.value, "1.25", label);
    }
});

test("a new id avoids names that the document waits for", () => {
  assert.equal(addEntry(DOCUMENT, "Head/nod", 0)?.id, "nod2");
});

test("a spoken line is escaped, and needs words", () => {
  assert.ok(addSpeech(DOCUMENT, " a < b ", 0)?.text.includes('<speech id="s"><text>a &lt; b</text></speech>'));
  assert.ok(addSpeech(DOCUMENT, "a", 2)?.text.includes('<speech id="s" start="2">'));
  assert.equal(addSpeech(DOCUMENT, "  ", 0), null);
});

test("an unknown entry, or a text that is no document, changes nothing", () => {
  for (const value of ["", "Head/none", "constructor/nod"]) assert.equal(addEntry(DOCUMENT, value, 0), null);
  assert.equal(addEntry("no document", "Head/nod", 0), null);
});
