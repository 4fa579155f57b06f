// Reasons for a chosen gesture that is not the first of the list, or is made with the left hand.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Alternative } from "../src/text_mode/alternatives.ts";
import { explainHand, explainRank } from "../src/text_mode/choice_reasons.ts";
import type { ShownGesture, SpokenWord } from "../src/text_mode/spoken.ts";
import type { Draft } from "../src/types.ts";

const gesture = (name: string, isPicked = false) => ({ name, isPicked }) as ShownGesture;
const word = (text: string, start: number, ...names: string[]) =>
  ({ text, start, gestures: names.map((name) => gesture(name)) }) as SpokenWord;
const list = (...ids: string[]) => ids.map((id) => ({ id })) as Alternative[];

test("gestures that rank before the chosen one are named, with the word that shows them already", () => {
  const here = word("huge", 10, "wide");
  const words = [word("large", 2, "big"), word("big", 7, "big"), here, word("vast", 71, "tall")];
  assert.equal(
    explainRank(here, gesture("wide"), list("big", "tall", "wide"), words),
    "Number 3 of the list: big is shown at “big” already; tall fits as well; the choice varies with style and neighbours.",
  );
  assert.equal(
    explainRank(here, gesture("wide"), list("open", "tall", "wide"), words),
    "Number 3 of the list: open, tall fit as well; the choice varies with style and neighbours.",
  );
});

test("no rank is explained for the first of the list, for a picked gesture, and for one outside of the list", () => {
  const here = word("huge", 10, "wide");
  assert.equal(explainRank(here, gesture("wide"), list("wide", "big"), [here]), "");
  assert.equal(explainRank(here, gesture("wide", true), list("big", "wide"), [here]), "");
  assert.equal(explainRank(here, gesture("wide"), list("big"), [here]), "");
});

test("the left hand is explained by the document, or by what the right hand shows at this time", () => {
  const behaviours = [
    { id: "a", label: "big", tracks: ["r_hand"] },
    { id: "b", label: "small", tracks: ["l_hand"] },
    { id: "c", label: "wide", tracks: ["r_hand", "l_hand"] },
    { id: "d", label: "here", tracks: ["l_hand"] },
    { id: "e", label: "open", tracks: ["r_hand", "l_hand"] },
  ];
  const syncs = Object.entries({ a: [0, 3], b: [2, 4], c: [5, 6], d: [6.5, 7], e: [6, 6.6] }).flatMap(
    ([behaviour, [start, end]]) => [
      { behaviour, sync: "start", planned: start },
      { behaviour, sync: "end", planned: end },
    ],
  );
  const draft = { behaviours, syncs } as unknown as Draft;
  assert.equal(explainHand("a", undefined, draft), "");
  assert.equal(explainHand("c", undefined, draft), "");
  assert.equal(explainHand("b", undefined, draft), "Left hand: the right hand shows big at this time.");
  assert.equal(explainHand("b", "LEFT_HAND", draft), "Left hand: the document asks for it.");
  assert.equal(explainHand("d", undefined, draft), "Left hand: the gesture is made with it.");
});
