// Checks of complete and broken answers of the server.
import assert from "node:assert/strict";
import { test } from "node:test";
import { readDraft, readReached, readReport } from "../src/checks.ts";

const HINGES = 2;
const servos = { celsius: [40, null], load: [0, 0], volts: [12, null], errors: [0, null], torque: [1, 0] };
const report = { angles: [0.1, null], planned: [0, 0.2], servos };
const reached = { angles: [0.1, 0.2], residual: 0, limits: ["l_elbow"], contact: null };
const draft = {
  ...{ block: "b", angles: "", loudness: "", duration: 1, zero: 0, rate: 50 },
  ...{ behaviours: [], syncs: [], words: [], phonemes: [], accents: [], notices: [] },
};

test("complete answers are accepted unchanged", () => {
  assert.equal(readReport(report, HINGES), report);
  assert.ok(readReport({ ...report, servos: null }, HINGES));
  assert.equal(readReached(reached, HINGES), reached);
  assert.ok(readReached({ ...reached, contact: ["hand", "head"] }, HINGES));
  assert.equal(readDraft(draft), draft);
});

test("incomplete answers and another number of joints are rejected", () => {
  for (const name of ["angles", "planned", "servos"])
    assert.equal(readReport({ ...report, [name]: undefined }, HINGES), null);
  for (const name of ["angles", "residual", "limits", "contact"])
    assert.equal(readReached({ ...reached, [name]: undefined }, HINGES), null);
  for (const name of Object.keys(draft)) assert.equal(readDraft({ ...draft, [name]: undefined }), null);
  assert.equal(readReport(report, HINGES + 1), null);
  assert.equal(readReport({ ...report, servos: { ...servos, volts: [12] } }, HINGES), null);
  assert.equal(readReached(reached, HINGES + 1), null);
});

test("angles must be numbers, or null for a silent servo", () => {
  for (const wrong of ["0", Number.NaN, Number.POSITIVE_INFINITY, {}, [0]]) {
    assert.equal(readReport({ ...report, planned: [0, wrong] }, HINGES), null);
    assert.equal(readReached({ ...reached, angles: [0, wrong] }, HINGES), null);
    assert.equal(readDraft({ ...draft, duration: wrong }), null, String(wrong));
  }
  assert.equal(readReport({ ...report, planned: [0, null] }, HINGES), null);
});
