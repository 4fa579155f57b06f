// Backups of unsaved documents: a reload, a crash or another document loses nothing.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { Window } from "happy-dom";
import { EXAMPLE, name, open } from "./files_desk.ts";
import { click, element, settle, sockets } from "./page.ts";

const end = (window: Window) => window.dispatchEvent(new window.Event("pagehide"));
const backups = (window: Window) => Object.keys(window.localStorage).filter((key) => key.startsWith("kinesic.backup."));

test("a change is marked, and backed up in the browser and in the folder; undoing it removes both", async () => {
  const { window, desk } = open();
  assert.equal(name(), "greeting.bml");
  desk.edit("<bml>1</bml>");
  assert.equal(name(), "• greeting.bml");
  assert.ok(window.document.title.startsWith("• greeting.bml"));
  const before = Date.now() / 1000;
  mock.timers.tick(200);
  assert.equal(JSON.parse(window.localStorage.getItem(backups(window)[0]!)!).text, "<bml>1</bml>");
  assert.equal(desk.files.saving.place, "browser");
  mock.timers.tick(300);
  const request = await desk.answer("backup", { told: "backed_up" });
  assert.deepEqual([request.name, request.text, request.revision], ["greeting.bml", "<bml>1</bml>", ""]);
  assert.ok(Number(request.time) >= before);
  assert.equal(desk.files.saving.place, "folder");
  desk.edit(EXAMPLE);
  assert.equal(name(), "greeting.bml");
  assert.deepEqual(backups(window), []);
  assert.deepEqual(desk.read(), [{ do: "backup", id: (request.id as number) + 1, key: request.key }]);
});

test("continuous typing is backed up too, one request at a time", async () => {
  const { desk } = open();
  for (let k = 0; k < 10; k++) {
    desk.edit(`<bml>${k}</bml>`);
    mock.timers.tick(100);
  }
  const first = await desk.answer("backup", { told: "backed_up" });
  assert.ok(String(first.text).includes("4"));
  const second = await desk.answer("backup", { told: "backed_up" });
  assert.ok(String(second.text).includes("9"));
  assert.deepEqual(desk.read(), []);
});

test("changes during a lost connection reach the folder when the server is back", async () => {
  const { desk } = open();
  desk.edit("<bml>1</bml>");
  sockets[0]?.close();
  mock.timers.tick(500);
  await settle();
  desk.socket = sockets.length - 1;
  sockets.at(-1)?.open();
  void desk.files.connected();
  assert.equal((await desk.answer("backup", { told: "backed_up" })).text, "<bml>1</bml>");
});

test("a backup is still offered if the connection was lost before the folder listed its backups", async () => {
  const { window, desk } = open();
  void desk.files.connected();
  await settle();
  sockets[0]?.close();
  await settle();
  assert.ok(element("recovery").hidden);
  const reconnect = async () => {
    mock.timers.tick(1000);
    desk.socket = sockets.length - 1;
    sockets.at(-1)?.open();
    void desk.files.connected();
    await settle();
  };
  await reconnect();
  const left = { key: "k1", name: "left.bml", revision: "", time: 1 };
  await desk.answer("backups", { told: "backups", backups: [left] });
  await settle();
  assert.ok(!element("recovery").hidden);
  click(window, "recover-later");
  sockets.at(-1)?.close();
  await settle();
  await reconnect();
  assert.ok(!desk.read().some(({ do: verb }) => verb === "backups"), "it is offered once");
  assert.ok(element("recovery").hidden);
});

test("typed words without gestures are unsaved, kept when another document opens, and restored", async () => {
  const { window, desk } = open();
  const typed = 'Tea -- and "coffee" --> today.';
  desk.typed = typed;
  desk.files.saving.changed();
  assert.equal(name(), "• greeting.bml");
  desk.files.choose("example", "greeting");
  const { key, text } = await desk.answer("backup", { told: "backed_up" });
  assert.equal(desk.typed, "");
  assert.equal(name(), "greeting.bml");
  desk.files.choose("backup", String(key));
  await desk.answer("backups", { told: "refused", why: "the server's folder is full" });
  assert.deepEqual([desk.text, desk.typed], [EXAMPLE, typed]);
  assert.equal(name(), "• greeting.bml");
  window.localStorage.clear(); // as in another browser
  desk.files.choose("backup", String(key));
  await desk.answer("backups", { told: "backup", key, name: "greeting.bml", revision: "", text });
  assert.deepEqual([desk.text, desk.typed], [EXAMPLE, typed]);
  const comment = String(text).slice(EXAMPLE.length);
  assert.match(comment, /^\n<!-- .* -->\n$/);
  assert.ok(!comment.slice(5, -4).includes("--"), "XML allows no two hyphens in a comment");
});

test("the browser asks before a page with unsaved changes ends, and only then", () => {
  const { window, desk } = open();
  const leaves = () => {
    const event = new window.Event("beforeunload", { cancelable: true });
    window.dispatchEvent(event);
    return !event.defaultPrevented;
  };
  assert.ok(leaves());
  desk.edit("x");
  assert.ok(!leaves());
});

test("a reload brings unsaved changes back at once, of the last keystroke too", () => {
  const { window, desk } = open();
  desk.edit("<bml>1</bml>");
  end(window);
  const again = open(undefined, { local: window, session: window });
  assert.equal(again.desk.text, "<bml>1</bml>");
  assert.equal(name(), "• greeting.bml");
  assert.equal(again.desk.files.saving.key, desk.files.saving.key);
});

test("a reload shows the saved file again", async () => {
  const { window, desk } = open();
  desk.files.choose("file", "tea.bml");
  await desk.answer("open", { told: "document", text: "tea", revision: "r1" });
  end(window);
  const again = open(undefined, { local: window, session: window }).desk;
  const connected = again.files.connected();
  await again.answer("open", { told: "document", text: "tea", revision: "r1" });
  assert.ok(await connected);
  assert.equal(again.text, "tea");
});

test("after a crash the changes are offered, restored with their file, or discarded", async () => {
  const { window, desk } = open();
  desk.edit("<bml>1</bml>");
  mock.timers.tick(200);
  for (const choice of ["recover", "recover-discard", "recover-later"]) {
    const again = open(undefined, { local: window });
    assert.equal(again.desk.text, EXAMPLE);
    void again.desk.files.connected();
    await settle();
    await again.desk.answer("backups", { told: "backups", backups: [] });
    assert.ok(!element("recovery").hidden);
    assert.match(element("recovered").textContent ?? "", /^Unsaved changes of greeting.bml are left from /);
    click(again.window, choice);
    await settle();
    if (choice === "recover") await again.desk.answer("backups", { told: "refused", why: "no backup" });
    assert.ok(element("recovery").hidden);
    assert.equal(again.desk.text, choice === "recover" ? "<bml>1</bml>" : EXAMPLE);
    assert.equal(backups(again.window).length, choice === "recover-discard" ? 0 : 1);
  }
});

test("of two backups of a document the newer one is listed and restored", async () => {
  for (const [age, restored] of [
    [-1, "<bml>of the folder</bml>"],
    [1, "<bml>of the browser</bml>"],
  ] as const) {
    const { window, desk } = open();
    desk.edit("<bml>of the browser</bml>");
    mock.timers.tick(200);
    const { key } = desk.files.saving;
    const time = Date.now() / 1000 - age;
    const again = open(undefined, { local: window });
    void again.desk.files.connected();
    await settle();
    const header = { key, name: "greeting.bml", revision: "", time };
    await again.desk.answer("backups", { told: "backups", backups: [header] });
    assert.ok(!element("recovered").textContent?.includes("more"), "both are one document");
    click(again.window, "recover");
    await settle();
    await again.desk.answer("backups", { told: "backup", ...header, text: "<bml>of the folder</bml>" });
    assert.equal(again.desk.text, restored);
  }
});

test("a backup that only the folder has is restored with its revision", async () => {
  const { window, desk } = open();
  void desk.files.connected();
  await settle();
  const header = { key: "a".repeat(16), name: "tea.bml", revision: "r1", time: 1 };
  await desk.answer("backups", { told: "backups", backups: [header] });
  click(window, "recover");
  await settle();
  await desk.answer("backups", { told: "backup", ...header, text: "unsaved" });
  assert.equal(desk.text, "unsaved");
  void desk.files.saving.save(false);
  assert.equal((await desk.answer("save", { told: "saved", revision: "r2" })).revision, "r1");
  assert.equal(name(), "tea.bml");
});

test("opening another document keeps the changes of the first", async () => {
  const { window, desk } = open();
  desk.edit("<bml>1</bml>");
  const { key } = desk.files.saving;
  desk.files.choose("example", "greeting");
  assert.notEqual(desk.files.saving.key, key);
  assert.deepEqual(backups(window), [`kinesic.backup.${key}`]);
  assert.equal((await desk.answer("backup", { told: "backed_up" })).key, key);
  assert.match(desk.said[0] ?? "", /unsaved changes of greeting.bml are kept/);
});
