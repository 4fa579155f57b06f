// State of the page for tests and debugging.
import type { Studio } from "./studio.ts";

export function readState(studio: Studio): Record<string, unknown> {
  const { document, files, plan, playback, player, robot, tracks, view } = studio;
  return {
    ...view.state(),
    connection: robot.wire.state,
    text: document.text,
    past: document.undoSteps,
    name: files.saving.name,
    unsaved: files.saving.unsaved,
    place: files.saving.place,
    planned: plan.count,
    plannedText: plan.text,
    time: player.time,
    performs: studio.performing.runs,
    selected: [...tracks.selection.all],
    heard: playback.voice.time,
    stopped: robot.stopped,
    draft: plan.draft && { ...plan.draft, angles: plan.draft.angles.length },
    report: robot.report,
  };
}
