// The timeline with its drags, keys, menus, palette and pictures.
import { byId } from "../dom.ts";
import { Timeline } from "../timeline.ts";
import { listenToTracks } from "./commands.ts";
import type { DragListener } from "./drags.ts";
import { type TrackDesk, TrackEditing } from "./editing.ts";
import { type Figures, listenToPreviews } from "./figures.ts";
import { listenToDrops } from "./palette_drag.ts";
import type { PoseListener } from "./pose_row.ts";

/** Parts of the page that the timeline needs. */
export interface TimelineDesk extends TrackDesk {
  seek(time: number): void;
  /** Add an entry of the palette at the time of the slider. */
  add(value: string): void;
  /** Changes of the key poses of a gesture under edit. */
  poses: PoseListener;
}

/** Connect the timeline to the page. */
export function openTimeline(desk: TimelineDesk, figures: Figures): { tracks: TrackEditing; timeline: Timeline } {
  const tracks = new TrackEditing(desk);
  const drags: DragListener = {
    moved: (move) => tracks.move(move),
    seek: (time) => {
      if (tracks.selection.last !== undefined) tracks.chooseAll([], false);
      desk.seek(time);
    },
    choose: (id, isExtended) => tracks.choose(id, isExtended),
    chooseAll: (ids, isExtended) => tracks.chooseAll(ids, isExtended),
  };
  const timeline = new Timeline(byId("rows"), figures, drags, desk.poses);
  listenToTracks(tracks, timeline);
  listenToDrops(timeline, {
    drop: (value, snap) => tracks.drop(value, snap),
    press: (value) => desk.add(value),
  });
  for (const list of ["found", "alternatives-list"]) listenToPreviews(byId(list), figures);
  return { tracks, timeline };
}
