// Behaviours that differ from their request: the reason on hover, for screen readers and in the details.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Inspection } from "../src/inspection.ts";
import type { StylesPanel } from "../src/styles/styles_panel.ts";
import { drawTrack } from "../src/tracks/blocks.ts";
import { layOut } from "../src/tracks/layout.ts";
import type { Draft } from "../src/types.ts";
import { element, load } from "./page.ts";

const WHY = "moved to the left hand: the right one is busy";
const WARNING = `differs from the request: ${WHY}`;
const behaviour = (id: string, outcome: string, why: string) => ({
  ...{ id, type: "gesture", label: "wave_small", tracks: ["r_hand"], outcome, why },
});
const sync = (id: string, name: string, time: number) => ({ behaviour: id, sync: name, asked: time, planned: time });
const draft = {
  duration: 4,
  behaviours: [behaviour("g1", "substituted", WHY), behaviour("g2", "realised", "a synonym of wave")],
  syncs: ["g1", "g2"].flatMap((id) => [sync(id, "start", 0), sync(id, "stroke", 1), sync(id, "end", 2)]),
  words: [],
  accents: [],
} as unknown as Draft;

test("a block in the warning colour gives the reason on hover, also over its stroke", () => {
  load();
  const drawing = { duration: 4, selected: new Set<string>(), percent: () => "0%", picture: () => null };
  const drawn = layOut(draft).rows.map((row) => drawTrack(row, drawing, []));
  const find = (selector: string) => drawn.map((row) => row.querySelector<HTMLElement>(selector)).find(Boolean)!;
  for (const selector of ["[data-block=g1]", "[data-stroke=g1]"])
    assert.ok(find(selector).title.endsWith(`\n${WARNING}`), selector);
  assert.ok(find("[data-block=g1]").getAttribute("aria-label")!.endsWith(`, ${WARNING}`));
  assert.ok(find("[data-block=g1]").matches(".substituted"));
  for (const selector of ["[data-block=g2]", "[data-stroke=g2]"])
    assert.doesNotMatch(find(selector).title, /\n|synonym/, selector);
});

test("the details of a behaviour give the reason, those of several behaviours none", () => {
  load();
  let selected: string[] = [];
  const styles = { inherited: () => new Map() } as unknown as StylesPanel;
  const inspection = new Inspection(() => styles, {
    ...{ text: () => '<bml id="b"/>', edit: () => {}, draft: () => draft, selected: () => selected },
    ...{ isGesture: () => false, tried: () => new Map(), tryAgain: () => {} },
  });
  const look = (...ids: string[]) => {
    selected = ids;
    inspection.show();
    return element("chosen-warning").textContent;
  };
  assert.equal(look("g1"), WARNING);
  assert.equal(look("g2"), "");
  assert.equal(look("g1", "g2"), "");
  assert.equal(look(), "");
});
