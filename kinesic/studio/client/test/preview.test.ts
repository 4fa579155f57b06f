// Playback of a behaviour after its expressivity was changed.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Motion } from "../src/motion.ts";
import { Preview } from "../src/styles/preview.ts";
import type { Draft } from "../src/types.ts";
import { BLOCK } from "../src/xml.ts";
import { load } from "./page.ts";

const FORMER_MOTION = {} as Motion;
const DRAFT = { duration: 3, syncs: [] } as unknown as Draft;

/** Return a preview with a record of the shown modes and playbacks. */
function begin(): { preview: Preview; calls: string[] } {
  const window = load();
  Object.assign(globalThis, { matchMedia: window.matchMedia.bind(window) });
  const calls: string[] = [];
  const view = { motion: FORMER_MOTION, before: null, setMode: (mode: string) => void calls.push(mode) };
  const player = {
    playing: false,
    seek: (time: number) => void calls.push(`seek ${time}`),
    play: () => void calls.push("play"),
  };
  return { preview: new Preview(view, player), calls };
}

test("the draft of changed expressivity is played once in the plan", () => {
  const { preview, calls } = begin();
  preview.expect();
  preview.drafted(DRAFT, [BLOCK]);
  preview.drafted(DRAFT, [BLOCK]);
  assert.deepEqual(calls, ["plan", "seek 0", "play"]);
});

test("a draft that arrives after Perform is not played, so that the robot stays visible", () => {
  const { preview, calls } = begin();
  preview.expect();
  preview.cancel();
  preview.drafted(DRAFT, [BLOCK]);
  assert.deepEqual(calls, []);
});
