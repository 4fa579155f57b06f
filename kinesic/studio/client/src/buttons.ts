// Buttons that can be pressed in the present state of the page.
import { byId, say } from "./dom.ts";
import type { EditedDocument } from "./edited_document.ts";
import type { Robot } from "./robot.ts";

/** Enable the buttons that have an effect now, and disable the others. */
export function enableButtons(edited: EditedDocument, robot: Robot): void {
  const enable = (name: string, isEnabled: boolean) => {
    byId<HTMLButtonElement>(name).disabled = !isEnabled;
  };
  enable("undo", edited.undoSteps > 0);
  enable("redo", edited.redoSteps > 0);
  const { obstacle } = robot;
  enable("perform", obstacle === null);
  say(byId("perform"), obstacle ? `Perform (${obstacle.why})` : "Perform");
  byId("perform").title = obstacle?.remedy ?? "Perform on the robot (Ctrl Enter)";
  for (const name of ["save", "save-as"]) enable(name, robot.wire.state === "open");
}
