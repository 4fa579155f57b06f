// Keys of the page: Escape and Space stop, shortcuts need Ctrl.
import assert from "node:assert/strict";
import { test } from "node:test";
import { element, press } from "./page.ts";
import { controlled } from "./triggered_actions.ts";

test("Escape always stops, Space only outside of text fields and buttons", () => {
  const { window, acts } = controlled();
  const places = ["text", "search", "mode", "loop", "perform", "time", "canvas"];
  const stopsBySpace = ["time", "canvas"];
  for (const place of places) {
    acts.length = 0;
    const taken = press(window, "Escape", { on: element(place) });
    assert.ok(taken, place);
    assert.deepEqual(acts, ["stop"], place);
    acts.length = 0;
    const spaced = press(window, " ", { on: element(place) });
    assert.equal(spaced, stopsBySpace.includes(place), place);
    assert.deepEqual(acts, stopsBySpace.includes(place) ? ["stop"] : [], place);
  }
  acts.length = 0;
  assert.ok(press(window, " ", { on: document.body }));
  assert.ok(press(window, "Escape", { on: document.querySelector("summary")! }));
  assert.deepEqual(acts, ["stop", "stop"]);
});

test("Escape only closes the save dialog, a menu and the tour of a robot that rests, and stops elsewhere", () => {
  for (const rests of [true, false]) {
    const { window, acts } = controlled(rests);
    const menu = Object.assign(document.createElement("button"), { role: "menuitem" });
    const list = document.createElement("div");
    list.setAttribute("role", "menu");
    list.append(menu);
    document.body.append(list);
    const pressed = (on: Element) => {
      acts.length = 0;
      const isTaken = press(window, "Escape", { on });
      assert.deepEqual(acts, isTaken ? ["stop"] : []);
      return isTaken;
    };
    assert.equal(pressed(menu), !rests);
    assert.equal(pressed(element("tour-next")), !rests);
    for (const place of [document.body, element("text"), element("canvas")]) assert.ok(pressed(place));
    const [saving, arming] = [element<HTMLDialogElement>("saving"), element<HTMLDialogElement>("arming")];
    saving.showModal();
    assert.equal(pressed(element("save-name")), !rests);
    assert.equal(pressed(document.body), !rests);
    arming.showModal();
    assert.ok(pressed(element("save-name")), "the question before arming says that Escape stops");
    saving.close();
    assert.ok(pressed(element("arm-no")));
  }
});

test("shortcuts need Ctrl, and other keys are left to the browser", () => {
  const { window, acts } = controlled();
  const shortcuts = { z: "undo", Z: "redo", y: "redo", s: "save", Enter: "perform" };
  for (const [key, act] of Object.entries(shortcuts)) {
    acts.length = 0;
    assert.ok(!press(window, key));
    assert.deepEqual(acts, []);
    assert.ok(press(window, key, { ctrlKey: true }));
    assert.deepEqual(acts, [act]);
  }
  acts.length = 0;
  const shifted = new window.KeyboardEvent("keydown", { key: "z", metaKey: true, shiftKey: true, bubbles: true });
  document.body.dispatchEvent(shifted as unknown as Event);
  assert.deepEqual(acts, ["redo"]);
  assert.ok(!press(window, "q", { ctrlKey: true }));
  assert.deepEqual(acts, ["redo"]);
});
