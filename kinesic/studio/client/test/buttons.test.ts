// Buttons that are disabled, and the visible reason.
import assert from "node:assert/strict";
import { test } from "node:test";
import { enableButtons } from "../src/buttons.ts";
import { EditedDocument } from "../src/edited_document.ts";
import { element } from "./page.ts";
import { begin, body } from "./robot_scene.ts";

const edited = new EditedDocument(() => {});

test("Perform shows why it is disabled, and the remedy on hover", () => {
  const { robot, line, stopLine } = begin();
  const look = () => {
    enableButtons(edited, robot);
    const { disabled, textContent, title } = element<HTMLButtonElement>("perform");
    return [disabled, textContent, title];
  };
  line.tell(body("armed"));
  const ready = [false, "Perform", "Perform on the robot (Ctrl Enter)"];
  assert.deepEqual(look(), ready);
  line.tell(body("limp"));
  assert.deepEqual(look(), [true, "Perform (motors off)", "Switch the motors on first"]);
  line.tell(body("arming"));
  assert.deepEqual(look(), ready);
  stopLine.tell({ told: "stopped" });
  assert.deepEqual(look(), [true, "Perform (stopped)", "Press Resume first"]);
  line.close();
  assert.deepEqual(look(), [true, "Perform (no server)", "The page needs a connection to the robot"]);
});
