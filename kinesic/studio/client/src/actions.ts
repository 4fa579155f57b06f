// Effect of each button, menu and key of the page.
import type { Actions } from "./controls.ts";
import { byId } from "./dom.ts";
import type { Studio } from "./studio.ts";

export function listActions(studio: Studio): Actions {
  const { document, files, performances, player, playback, robot, tracks, view } = studio;
  return {
    play: () => void playback.toggle(Boolean(studio.plan.draft?.loudness)),
    perform: () => void performances.perform(),
    stop: () => performances.stop(),
    rests: () => performances.rests,
    resume: () => robot.resume(),
    undo: () => document.undo(),
    redo: () => document.redo(),
    save: () => void save(studio, false),
    saveAs: () => void save(studio, true),
    remove: () => tracks.remove(),
    show: (mode) => view.setMode(mode),
    view: (direction) => view.stage.view(direction),
    chooseBlock: () => {
      tracks.chooseAll([], false);
      byId("inspector").scrollIntoView({ block: "nearest" });
    },
    sectors: (on) => view.showSectors(on),
    seek: (time) => player.seek(time),
    style: (style) => robot.wire.tell("style", { style }),
    loop: (on) => {
      player.loops = on;
    },
    voice: (on) => playback.speak(on),
    list: () => files.fillMenu(),
    open: (kind, name) => files.choose(kind, name),
    unlock: (token) => robot.unlock(token),
  };
}

/** Choose the gestures of typed words, and save the document. */
async function save({ robot, textMode, files }: Studio, asksForName: boolean): Promise<void> {
  robot.askState(); // Escape stops in the dialog unless the robot rests
  if (textMode.typed && !(await textMode.finishToSave())) {
    robot.live.say("not saved: the new words have no gestures yet");
    return;
  }
  await files.saving.save(asksForName);
}
