// Saving and opening files: names, questions before a file is replaced, and earlier versions.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Window } from "happy-dom";
import { fileName, formatMoment } from "../src/names.ts";
import { name, open } from "./files_desk.ts";
import { element, settle } from "./page.ts";

function submit(window: Window, typed: string): void {
  element<HTMLInputElement>("save-name").value = typed;
  element("save-name").dispatchEvent(new window.Event("input") as unknown as Event);
  element("save-form").dispatchEvent(new window.Event("submit", { cancelable: true }) as unknown as Event);
}

test("the name is completed, and an existing file is replaced only after a question", async () => {
  const { window, desk } = open();
  void desk.files.saving.save(false);
  await desk.answer("open", { told: "documents", names: ["tea.bml", "wave.toml"] });
  assert.ok(element<HTMLDialogElement>("saving").open);
  assert.deepEqual(
    [...document.querySelectorAll("#save-names option")].map((each) => each.getAttribute("value")),
    ["tea"],
  );
  submit(window, "tea");
  assert.equal(element("save-file").textContent, "Saved as tea.bml in the folder of the studio.");
  const conflict = { told: "refused", conflict: true, why: "exists" };
  assert.equal((await desk.answer("save", conflict)).revision, "");
  assert.match(element("save-question").textContent ?? "", /Replace it\?/);
  assert.equal(element("save-ok").textContent, "Replace");
  submit(window, "tea two");
  assert.equal((await desk.answer("save", conflict)).name, "tea_two.bml", "another name is another question");
  element("save-form").dispatchEvent(new window.Event("submit", { cancelable: true }) as unknown as Event);
  assert.equal((await desk.answer("save", { told: "saved", revision: "r1" })).revision, null);
  assert.ok(!element<HTMLDialogElement>("saving").open);
  assert.equal(name(), "tea_two.bml");
});

test("a file that has a name is saved at once, unless another program has changed it", async () => {
  const { desk } = open();
  desk.files.choose("file", "tea.bml");
  await desk.answer("open", { told: "document", text: "tea", revision: "r1" });
  desk.edit("more tea");
  void desk.files.saving.save(false);
  const request = await desk.answer("save", { told: "refused", conflict: true, why: "changed" });
  assert.deepEqual([request.name, request.revision, request.text], ["tea.bml", "r1", "more tea"]);
  assert.ok(element<HTMLDialogElement>("saving").open);
  assert.equal(element("save-ok").textContent, "Replace");
});

test("a refused save is explained in the dialog, and the text stays unsaved", async () => {
  const { window, desk } = open();
  desk.edit("x");
  void desk.files.saving.save(true);
  submit(window, "con");
  await desk.answer("save", { told: "refused", why: "Windows reserves this one" });
  assert.equal(element("save-question").textContent, "Windows reserves this one");
  assert.ok(element<HTMLDialogElement>("saving").open);
  assert.ok(desk.files.saving.unsaved);
});

test("text that changes while it is saved stays marked", async () => {
  const { window, desk } = open();
  void desk.files.saving.save(true);
  submit(window, "tea");
  desk.edit("newer");
  await desk.answer("save", { told: "saved", revision: "r1" });
  assert.equal(name(), "• tea.bml");
});

test("an earlier version replaces the text like an edit", async () => {
  const { desk } = open();
  desk.files.choose("file", "tea.bml");
  await desk.answer("open", { told: "document", text: "tea", revision: "r1" });
  desk.files.choose("version", "3");
  const request = await desk.answer("versions", { told: "version", text: "old tea" });
  assert.deepEqual([request.name, request.number], ["tea.bml", 3]);
  assert.equal(desk.text, "old tea");
  assert.equal(name(), "• tea.bml");
});

test("the menu lists the folder, unsaved documents and versions", async () => {
  const { desk } = open();
  desk.files.choose("file", "tea.bml");
  await desk.answer("open", { told: "document", text: "tea", revision: "r1" });
  desk.files.fillMenu();
  await settle();
  await desk.answer("open", { told: "documents", names: ["tea.bml"] });
  const header = { key: "a".repeat(16), name: "new.bml", revision: "", time: 1 };
  await desk.answer("backups", { told: "backups", backups: [header] });
  await desk.answer("versions", { told: "versions", versions: [{ number: 2, time: 1 }] });
  const values = [...document.querySelectorAll("#examples option")].map((each) => each.getAttribute("value"));
  assert.deepEqual(values.slice(-3), ["file:tea.bml", `backup:${"a".repeat(16)}`, "version:2"]);
});

test("typed names become file names", () => {
  for (const [typed, wanted] of [
    ["tea", "tea.bml"],
    [" My tea talk ", "My_tea_talk.bml"],
    ["tea.bml", "tea.bml"],
    ["tea.toml", "tea.bml"],
    ["Grüße, Zoë!", "Grusse_Zoe.bml"],
    ["../../etc/passwd", "etc_passwd.bml"],
    [".hidden", "hidden.bml"],
    ["a".repeat(99), `${"a".repeat(64)}.bml`],
    ["日本", null],
    ["", null],
  ] as const)
    assert.equal(fileName(typed, ".bml"), wanted);
});

test("a time of another day has its day", () => {
  const now = new Date(2026, 5, 10, 12).getTime();
  assert.ok(!formatMoment(now - 60_000, now).includes("10"));
  assert.ok(formatMoment(now - 86_400_000 * 2, now).includes("8"));
});
