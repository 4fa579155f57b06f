// Wizard's panel: messages and log of its buttons, hotkeys, replay, and the exported tables.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Wire } from "../src/wire.ts";
import { Session } from "../src/wizard/session.ts";
import { WizardPanel } from "../src/wizard/wizard_panel.ts";
import { load, sockets } from "./page.ts";

/** Open the panel on a connected page. */
function begin() {
  const window = load();
  const wire = new Wire({ state: () => {}, told: () => {}, feedback: () => {} }, null);
  const shows = mock.fn();
  const panel = new WizardPanel(wire, () => {}, shows);
  const server = sockets[0]!;
  server.open();
  server.read();
  const button = (label: string) => {
    const found = [...document.querySelectorAll<HTMLElement>("#wizard button")].find(
      ({ textContent }) => textContent === label,
    );
    assert.ok(found, label);
    return found;
  };
  return { window, panel, server, press: (label: string) => button(label).click(), button, shows };
}

const labels = (panel: WizardPanel) => panel.session.entries.map(({ label }) => label);

test("each button sends its message and is logged", () => {
  const { panel, server, press } = begin();
  for (const label of ["Converse", "Think", "Hm.", "Yield", "Nobody"]) press(label);
  assert.deepEqual(server.read(), [
    { do: "converse", on: true },
    { do: "think", on: true },
    { do: "words", text: "Hm.", ends: true },
    { do: "interrupt", yield: true },
    { do: "people", people: [] },
  ]);
  assert.deepEqual(labels(panel), ["Converse on", "Think on", "Hm.", "Yield", "Nobody"]);
});

test("a second press of a state's button ends the state", () => {
  const { server, press, button } = begin();
  press("Listen");
  assert.equal(button("Listen").getAttribute("aria-pressed"), "true");
  press("Listen");
  assert.equal(button("Listen").getAttribute("aria-pressed"), "false");
  assert.deepEqual(
    server.read().map(({ voice }) => voice),
    [true, false],
  );
});

test("a person at whom the robot looks is reported until another press", () => {
  const { server, press } = begin();
  press("Look at left person");
  for (let k = 0; k < 2; k += 1) mock.timers.tick(450);
  assert.equal(server.read().length, 3);
  press("Nobody");
  mock.timers.tick(450);
  assert.equal(server.read().length, 1);
});

test("each nod is a block with an id of its own", () => {
  const { server, press } = begin();
  press("Nod");
  press("Nod");
  const sent = server.sent.splice(0);
  assert.match(sent[0]!, /id="wizard1".*lexeme="NOD"/);
  assert.match(sent[1]!, /id="wizard2"/);
});

test("Alt and a digit say a line only while the panel is open", () => {
  const { window, server, panel } = begin();
  const details = document.querySelector<HTMLDetailsElement>("#wizard")!;
  const strike = () =>
    document.dispatchEvent(new window.KeyboardEvent("keydown", { code: "Digit1", altKey: true }) as unknown as Event);
  strike();
  assert.deepEqual(server.read(), []);
  details.open = true;
  strike();
  assert.deepEqual(server.read(), [{ do: "words", text: "Hello, nice to see you!", ends: true }]);
  assert.deepEqual(labels(panel), ["Hello, nice to see you!"]);
});

test("a replay sends the presses of the session again at their times", () => {
  const { panel, server, press } = begin();
  panel.session.add(1000, "press", "Hm.", [{ do: "words", values: { text: "Hm.", ends: true } }]);
  panel.session.add(1500, "state", "thinking, nobody");
  panel.session.add(3000, "press", "Think on", [{ do: "think", values: { on: true } }]);
  press("Replay");
  mock.timers.tick(1);
  assert.equal(server.read().length, 1);
  mock.timers.tick(1900);
  assert.equal(server.read().length, 0);
  mock.timers.tick(200);
  assert.deepEqual(server.read(), [{ do: "think", on: true }]);
  assert.equal(panel.session.entries.length, 3);
});

test("a state of the robot is shown and logged, other messages are not", () => {
  const { panel } = begin();
  panel.hear({ told: "conversing", state: "listening", who: "p1" });
  panel.hear({ told: "pong" });
  assert.equal(document.querySelector("#wizard-state")?.textContent, "listening, p1");
  assert.deepEqual(labels(panel), ["listening, p1"]);
});

test("the wizard's own person is shown as a person, and logged by id", () => {
  const { panel } = begin();
  panel.hear({ told: "conversing", state: "listening", who: "wizard" });
  assert.equal(document.querySelector("#wizard-state")?.textContent, "listening, a person");
  assert.deepEqual(labels(panel), ["listening, wizard"]);
});

test("an ended conversation releases the buttons of its states", () => {
  const { panel, press, button, server } = begin();
  press("Converse");
  press("Think");
  panel.hear({ told: "conversing", state: "thinking" });
  assert.equal(button("Converse").getAttribute("aria-pressed"), "true");
  panel.hear({ told: "conversing", state: "off" });
  for (const label of ["Converse", "Think"]) assert.equal(button(label).getAttribute("aria-pressed"), "false");
  server.read();
  press("Converse");
  assert.deepEqual(server.read(), [{ do: "converse", on: true }]);
});

test("each press lets the stage show the robot", () => {
  const { press, shows } = begin();
  press("Converse");
  press("Nod");
  assert.equal(shows.mock.callCount(), 2);
});

test("the table has a row for each entry, and quotes a label with a comma", () => {
  const session = new Session();
  session.add(1000, "press", 'Well, "yes"');
  session.add(2250, "state", "thinking");
  assert.equal(session.csv(), 'time [s],kind,label\n0.000,press,"Well, ""yes"""\n1.250,state,thinking\n');
  session.clear();
  assert.equal(session.csv(), "time [s],kind,label\n");
});

test("the EAF document has a tier of presses and one of states that last until the next", () => {
  const session = new Session();
  session.add(0, "press", "a < b");
  session.add(100, "state", "listening");
  session.add(2000, "state", "thinking");
  const eaf = new DOMParser().parseFromString(session.eaf(new Date(0)), "application/xml");
  const slots = new Map(
    [...eaf.getElementsByTagName("TIME_SLOT")].map((slot) => [
      slot.getAttribute("TIME_SLOT_ID"),
      slot.getAttribute("TIME_VALUE"),
    ]),
  );
  const read = (name: string) => {
    const tier = [...eaf.getElementsByTagName("TIER")].find((found) => found.getAttribute("TIER_ID") === name);
    return [...(tier?.getElementsByTagName("ALIGNABLE_ANNOTATION") ?? [])].map((found) => [
      ...["TIME_SLOT_REF1", "TIME_SLOT_REF2"].map((key) => slots.get(found.getAttribute(key))),
      found.textContent,
    ]);
  };
  assert.deepEqual(read("wizard"), [["0", "200", "a < b"]]);
  assert.deepEqual(read("robot"), [
    ["100", "2000", "listening"],
    ["2000", "2200", "thinking"],
  ]);
});
