// Saving, backups and recovery in the page: nothing is lost, and no file is replaced without a question.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { Window } from "happy-dom";
import { Files } from "../src/files.ts";
import { fileName, formatMoment } from "../src/names.ts";
import type { About } from "../src/types.ts";
import { Wire } from "../src/wire.ts";
import { click, element, load, settle, sockets } from "./page.ts";

const EXAMPLE = "<bml/>";
const ABOUT = { examples: [{ name: "greeting", text: EXAMPLE }], document: null } as unknown as About;

type Message = Record<string, unknown>;

/** The files of a page with a server that the test plays. */
class Desk {
  text = "";
  typed = "";
  readonly said: string[] = [];
  readonly files: Files;
  socket = 0; // index of the connection; the stop line has another
  private waiting: Message[] = [];

  constructor(about: About = ABOUT) {
    const wire = new Wire({ state: () => {}, told: () => {}, feedback: () => {} }, null);
    this.files = new Files(about, wire, {
      text: () => this.text,
      typed: () => this.typed,
      retype: (typed) => {
        this.typed = typed;
      },
      show: (text) => {
        this.text = text;
        this.typed = "";
      },
      edit: (text) => this.edit(text),
      saved: () => {},
      say: (text) => this.said.push(text),
    });
    this.files.begin();
    sockets[0]?.open();
    this.read();
  }

  edit(text: string): void {
    this.text = text;
    this.files.saving.changed();
  }

  read(): Message[] {
    return [...this.waiting.splice(0), ...(sockets[this.socket]?.read() ?? [])];
  }

  /** Answer the next request of a kind, and return it. */
  async answer(verb: string, told: Message): Promise<Message> {
    const all = this.read();
    const request = all.find((each) => each.do === verb);
    assert.ok(request, `no ${verb} in ${JSON.stringify(all)}`);
    this.waiting = all.filter((each) => each !== request);
    sockets[this.socket]?.tell({ id: request.id, ...told });
    await settle();
    return request;
  }
}

/** Open a page; a reload keeps the storage of its tab. */
function open(about?: About, kept: { local?: Window; session?: Window } = {}): { window: Window; desk: Desk } {
  const window = load();
  for (const [from, to] of [
    [kept.local?.localStorage, window.localStorage],
    [kept.session?.sessionStorage, window.sessionStorage],
  ] as const)
    for (let k = 0; from && k < from.length; k++) to.setItem(from.key(k) ?? "", from.getItem(from.key(k) ?? "") ?? "");
  return { window, desk: new Desk(about) };
}

const end = (window: Window) => window.dispatchEvent(new window.Event("pagehide"));
const backups = (window: Window) => Object.keys(window.localStorage).filter((key) => key.startsWith("kinesic.backup."));
const name = () => element("file").textContent;

function submit(window: Window, typed: string): void {
  element<HTMLInputElement>("save-name").value = typed;
  element("save-name").dispatchEvent(new window.Event("input") as unknown as Event);
  element("save-form").dispatchEvent(new window.Event("submit", { cancelable: true }) as unknown as Event);
}

test("a change is marked, and backed up in the browser and in the folder; undoing it removes both", async () => {
  const { window, desk } = open();
  assert.equal(name(), "greeting.bml");
  desk.edit("<bml>1</bml>");
  assert.equal(name(), "• greeting.bml");
  assert.ok(window.document.title.startsWith("• greeting.bml"));
  mock.timers.tick(200);
  assert.equal(JSON.parse(window.localStorage.getItem(backups(window)[0]!)!).text, "<bml>1</bml>");
  assert.equal(desk.files.saving.place, "browser");
  mock.timers.tick(300);
  const request = await desk.answer("backup", { told: "backed_up" });
  assert.deepEqual([request.name, request.text, request.revision], ["greeting.bml", "<bml>1</bml>", ""]);
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
  await settle();
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
    assert.ok(element("recovery").hidden);
    assert.equal(again.desk.text, choice === "recover" ? "<bml>1</bml>" : EXAMPLE);
    assert.equal(backups(again.window).length, choice === "recover-discard" ? 0 : 1);
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
