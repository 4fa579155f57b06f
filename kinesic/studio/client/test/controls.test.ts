// Buttons, menus and fields of the page.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Actions, listen } from "../src/controls.ts";
import { click, element, load } from "./page.ts";
import { controlled } from "./triggered_actions.ts";

test("each button, menu and field triggers its action", () => {
  const { window, acts } = controlled();
  const buttons = ["play", "perform", "stop", "resume", "undo", "redo", "save", "remove"];
  for (const name of buttons) {
    element<HTMLButtonElement>(name).disabled = false;
    click(window, name);
  }
  assert.deepEqual(acts.splice(0), buttons);
  for (const id of ["mode-plan", "mode-robot", "view-front", "choose-block"]) click(window, id);
  assert.deepEqual(acts.splice(0), ["show plan", "show robot", "view front", "chooseBlock"]);
  for (const on of ["true", "false"]) {
    click(window, "show-sectors");
    assert.deepEqual(acts.splice(0), [`sectors ${on}`]);
    assert.equal(element("show-sectors").getAttribute("aria-pressed"), on);
  }
  const change = (id: string, type: string) =>
    element(id).dispatchEvent(new window.Event(type, { bubbles: true }) as unknown as Event);
  element<HTMLInputElement>("time").value = "0.5";
  change("time", "input");
  element<HTMLInputElement>("loop").checked = true;
  change("loop", "change");
  element<HTMLInputElement>("voice").checked = false;
  change("voice", "change");
  assert.deepEqual(acts.splice(0), ["seek 0.5", "loop true", "voice false"]);
  element("style").append(Object.assign(document.createElement("option"), { value: "joyful" }));
  element<HTMLSelectElement>("style").value = "joyful";
  change("style", "change");
  assert.deepEqual(acts.splice(0), ["style joyful"]);
});

test("the menu lists documents when opened and opens a selected one", () => {
  const { window, acts } = controlled();
  const menu = element<HTMLSelectElement>("examples");
  const option = Object.assign(document.createElement("option"), { value: "saved:my:file.bml" });
  menu.append(option);
  menu.dispatchEvent(new window.Event("pointerdown") as unknown as Event);
  menu.value = option.value;
  const opened: unknown[] = [];
  const actions = { open: (kind: string, name: string) => opened.push(kind, name) };
  load();
  listen({ ...actions } as unknown as Actions);
  const again = element<HTMLSelectElement>("examples");
  again.append(Object.assign(document.createElement("option"), { value: "saved:my:file.bml" }));
  again.value = "saved:my:file.bml";
  again.dispatchEvent(new window.Event("change") as unknown as Event);
  assert.deepEqual(acts, ["list"]);
  assert.deepEqual(opened, ["saved", "my:file.bml"]);
  assert.equal(again.value, "");
});

test("the form passes on the token without a page load", () => {
  const { window, acts } = controlled();
  element<HTMLInputElement>("token").value = "secret";
  const event = new window.Event("submit", { bubbles: true, cancelable: true });
  element("lock").dispatchEvent(event as unknown as Event);
  assert.deepEqual(acts, ["unlock secret"]);
  assert.ok(event.defaultPrevented);
});
