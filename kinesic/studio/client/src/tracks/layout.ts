// Rows of the timeline: one track per body part; behaviours that overlap in a track get a lane each.
import type { Behaviour, Draft } from "../types.ts";
import { type Points, pointsOf, spanOf } from "./phases.ts";

/** Names of the tracks, top to bottom. */
export const TRACKS: readonly (readonly [string, string])[] = [
  ["voice", "voice"],
  ["r_hand", "right hand"],
  ["l_hand", "left hand"],
  ["head", "head"],
  ["gaze", "gaze"],
  ["torso", "trunk"],
  ["face", "face"],
];
const OTHER = "other"; // track of pauses and unknown behaviours

export interface Placed {
  behaviour: Behaviour;
  points: Points;
  from: number;
  to: number;
  lane: number;
  /** Whether it is the behaviour's first track; a two-handed gesture is in two. */
  first: boolean;
}

export interface TrackRow {
  track: string;
  name: string;
  lanes: number;
  items: Placed[];
}

/** Return the tracks of a draft, and the behaviours without times, which are not performed. */
export function layOut(draft: Draft): { rows: TrackRow[]; unplaced: Behaviour[] } {
  const points = pointsOf(draft);
  const rows = [...TRACKS, [OTHER, OTHER] as const].map(([track, name]) => {
    const own = draft.behaviours.filter(({ id, tracks }) => points.has(id) && inTrack(tracks, track));
    return { track, name, ...stack(own.map((each) => place(each, points.get(each.id)!, track))) };
  });
  const shown = rows.filter(({ track, items }) => track !== OTHER || items.length);
  return { rows: shown, unplaced: draft.behaviours.filter(({ id }) => !points.has(id)) };
}

const inTrack = (tracks: readonly string[], track: string): boolean =>
  track === OTHER ? !tracks.length : tracks.includes(track);

const place = (behaviour: Behaviour, points: Points, track: string): Placed => ({
  behaviour,
  points,
  ...spanOf(points),
  lane: 0,
  first: (behaviour.tracks[0] ?? OTHER) === track,
});

/** Put each item into the first lane that is free at its start. */
function stack(items: Placed[]): { items: Placed[]; lanes: number } {
  const ends: number[] = [];
  const placed = [...items]
    .sort((a, b) => a.from - b.from)
    .map((item) => {
      const free = ends.findIndex((end) => end <= item.from + 1e-6);
      const lane = free < 0 ? ends.length : free;
      ends[lane] = item.to;
      return { ...item, lane };
    });
  return { items: placed, lanes: Math.max(1, ends.length) };
}
