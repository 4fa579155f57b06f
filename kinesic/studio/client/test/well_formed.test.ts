// Random edits leave well-formed XML: every document is parsed by expat, a parser that knows namespaces.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { edited, randomly, texts } from "./random_edits.ts";

const SEQUENCES = 1000;
const EDITS = 30; // in each sequence
/** Reads a JSON list of documents; prints the index and the error of the first that is not well-formed. */
const PARSER = `
import json, sys
from xml.parsers.expat import ExpatError, ParserCreate
for number, text in enumerate(json.load(sys.stdin)):
    try:
        ParserCreate(namespace_separator=" ").Parse(text.encode(), True)
    except ExpatError as error:
        print(number, error)
        break
`;
const PYTHON = process.env.PYTHON ?? "python3";

/** Documents with other prefixes than the examples. */
const OTHERS = [
  '<b:bml xmlns:b="urn:b" id="b"><b:speech id="s"><b:text>one <!-- > --> two</b:text></b:speech><b:gesture id="g"/></b:bml>',
  '<bml id="b" xmlns:kinesic="urn:other"><gesture id="g" kinesic:power="1"/></bml>',
  '<bml id="b"/>',
  '<w:act xmlns:w="urn:w" xmlns:k="urn:kinesic"><bml id="b"><gesture id="g" k:power="1" stroke="s:m1"/></bml></w:act>',
  '<bml id="b"><gesture id="g" xmlns:k="urn:kinesic" k:power="1"/><gesture id="h"/></bml>',
];

test("each of 1000 random sequences of edits is well-formed with every prefix declared", (context) => {
  if (spawnSync(PYTHON, ["--version"]).error) return context.skip(`no ${PYTHON}: set PYTHON`);
  const begins = [...texts, ...OTHERS];
  const documents: string[] = [];
  for (let seed = 0; seed < SEQUENCES; seed++) {
    const random = randomly(seed);
    let text = begins[seed % begins.length]!;
    for (let k = 0; k < EDITS; k++) text = edited(text, random);
    documents.push(text);
  }
  const { stdout, stderr } = spawnSync(PYTHON, ["-c", PARSER], { input: JSON.stringify(documents), encoding: "utf8" });
  assert.equal(stderr, "");
  assert.equal(stdout && `${stdout}\n${documents[Number.parseInt(stdout, 10)]}`, "");
  assert.ok(documents.some((text) => text.includes("kinesic:style")));
});
