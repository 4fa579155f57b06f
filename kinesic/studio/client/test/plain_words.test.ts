// Plain words in place of ids: gestures, beats and notices.
import assert from "node:assert/strict";
import { test } from "node:test";
import { showNotices } from "../src/panels.ts";
import { gestureId, gestureWords, isBeat, labelWords, progressWords } from "../src/plain_words.ts";
import { AlternativesPanel } from "../src/text_mode/alternatives.ts";
import { describeCounts, type SpokenWord } from "../src/text_mode/spoken.ts";
import type { Draft } from "../src/types.ts";
import { element, load } from "./page.ts";

const GESTURES = ["tiny_low", "narrow_low", "weigh_up"].map((id) => ({ id, category: "iconic", says: "" }));
const spoken = (...names: string[]): SpokenWord[] => [
  { gestures: names.map((name) => ({ name })) } as unknown as SpokenWord,
];

test("a gesture that is typed in words has the id of these words", () => {
  for (const id of ["weigh_up", "beat", "count_three"]) assert.equal(gestureId(gestureWords(id)), id);
  assert.equal(gestureId("  weigh  up "), "weigh_up");
});

test("targets of the eyes and of pointing hands are named in words, and spoken text is left as it is", () => {
  assert.equal(labelWords("gaze", "downright"), "down right");
  assert.equal(labelWords("pointing", "audience"), "the listener");
  assert.equal(labelWords("gaze", "DOWNLEFT"), "down left");
  assert.equal(labelWords("gaze", "UP"), "up");
  assert.equal(labelWords("gaze", "lamp"), "lamp");
  assert.equal(labelWords("speech", "upright"), "upright");
});

test("beats are told apart from gestures whose name begins alike", () => {
  assert.deepEqual(["beat", "BEAT", "beat_low_both", "beaten", "upbeat"].map(isBeat), [true, true, true, false, false]);
});

test("the count of gestures tells how many only stress a word", () => {
  assert.equal(describeCounts([]), "no spoken words");
  assert.equal(describeCounts(spoken("wave")), "1 word, 1 gesture");
  assert.equal(
    describeCounts(spoken("wave", "beat", "beat_both")),
    "1 word, 3 gestures, of which 2 only stress the word (beat)",
  );
});

test("a notice names its behaviour and gestures in words, and leaves other identifiers as they are", () => {
  load();
  const behaviours = [{ id: "g3", type: "gesture", label: "tiny_low" }];
  const notices = [
    { type: "", id: "said:g3", text: "tiny_low needs fingers; narrow_low is performed instead of l_thumb" },
    { type: "", id: "other", text: "late" },
  ];
  showNotices({ behaviours, notices } as unknown as Draft, GESTURES);
  const lines = [...element("notices").children].map((line) => line.textContent);
  assert.deepEqual(lines, [
    "gesture tiny low tiny low needs fingers; narrow low is performed instead of l_thumb",
    "other late",
  ]);
});

test("messages tell the progress of a performance in words", () => {
  const told = ["story:start", "story:far:relax", "story:s:laughed", "story:big:end"].map((about) =>
    progressWords("syncPointProgress", about),
  );
  assert.deepEqual(told, ["story: begins", "story, far: way back begins", "story, s: laughed", "story, big: ends"]);
  assert.equal(progressWords("predictionFeedback", ""), "the times of the performance are planned");
  assert.equal(progressWords("unknownFeedback", ""), "unknownFeedback");
});

test("a gesture for which the robot lacks fingers is listed with this reason", () => {
  load();
  const panel = new AlternativesPanel({ choose: () => {}, remove: () => {}, picture: () => null });
  const pinch = { id: "small_pinch", category: "", says: "", why: "'tiny' is small", intent: "" };
  panel.show("tiny", null, [
    { ...pinch, lacks: 'hand shape "gap" needs fingers' },
    { ...pinch, id: "narrow_low" },
  ]);
  const reasons = [...element("alternatives-list").querySelectorAll(".why")].map((each) => each.textContent);
  assert.deepEqual(reasons, ["'tiny' is small; hand shape \"gap\" needs fingers", "'tiny' is small"]);
});

test("beats are folded after the other gestures for a word, unless the word shows one", () => {
  load();
  const choices: string[] = [];
  const listener = { choose: ({ id }: { id: string }) => choices.push(id), remove: () => {}, picture: () => null };
  const panel = new AlternativesPanel(listener);
  const all = ["beat", "weigh_up", "beat_low"].map((id) => ({ id, category: "", says: "", why: "", intent: "" }));
  const rows = () => [...element("alternatives-list").querySelectorAll<HTMLElement>("[data-gesture]")];
  const isOpen = () => element("alternatives-list").querySelector("details")?.open;
  panel.show("versus", null, all);
  assert.deepEqual(
    rows().map((row) => row.dataset.gesture),
    ["weigh_up", "beat", "beat_low"],
  );
  assert.equal(isOpen(), false);
  assert.equal(
    element("alternatives-list").querySelector("summary")?.textContent,
    "2 small movements that stress the word",
  );
  rows()[2]?.click();
  assert.deepEqual(choices, ["beat_low"]);
  panel.show("versus", { name: "beat", reason: "" } as Parameters<typeof panel.show>[1], all);
  assert.equal(isOpen(), true);
  panel.show(
    "versus",
    null,
    all.filter(({ id }) => isBeat(id)),
  );
  assert.equal(isOpen(), undefined);
});
