// Arming: torque only after a person's click in the dialog, in time, and with the server's code.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Arming } from "../src/arming.ts";
import type { ServoReport } from "../src/types.ts";
import { Wire } from "../src/wire.ts";
import { click, element, load, type Socket, settle, sockets } from "./page.ts";

const LASTS = 30; // [s] validity of the server's question
const TOKEN = "secret";
const COUNT = 22; // servos

const report = (state: ServoReport["state"]): ServoReport => ({
  ...{ state, celsius: [], load: [], volts: [], errors: [], torque: [] },
});

interface Scene {
  window: ReturnType<typeof load>;
  arming: Arming;
  server: Socket;
  log: string[];
}

/** Show the page with servos in a state, connected to a server. */
function begin(state: ServoReport["state"] = "limp"): Scene {
  const window = load();
  const log: string[] = [];
  const wire = new Wire({ state: () => {}, told: () => {}, feedback: () => {} }, TOKEN);
  const arming = new Arming(
    wire,
    () => TOKEN,
    (text) => log.push(text),
  );
  arming.show(report(state));
  const server = sockets[0]!;
  server.open();
  server.read();
  return { window, arming, server, log };
}

/** Press Arm and let the server ask for confirmation. */
async function ask({ window, server }: Scene, code = "4711"): Promise<void> {
  click(window, "arm");
  const [question] = server.read();
  server.tell({ told: "confirm", id: question!.id, code, servos: COUNT, lasts: LASTS });
  await settle();
}

const isOpen = () => element<HTMLDialogElement>("arming").open;

test("Arm sends the token, and the server's question opens the dialog", async () => {
  const scene = begin();
  click(scene.window, "arm");
  assert.deepEqual(scene.server.read(), [{ do: "arm", id: 1, token: TOKEN }]);
  assert.ok(!isOpen(), "not before the server has answered");
  await ask(scene);
  assert.ok(isOpen());
  assert.equal(element("arm-count").textContent, String(COUNT));
  assert.deepEqual(scene.server.read(), [], "nothing is confirmed by the dialog alone");
});

test("a person's click confirms once with the code, and the answer is logged", async () => {
  const scene = begin();
  await ask(scene);
  click(scene.window, "arm-yes");
  const [confirmed, ...others] = scene.server.read();
  assert.deepEqual(confirmed, { do: "arm", id: 2, token: TOKEN, code: "4711" });
  assert.equal(others.length, 0);
  assert.ok(!isOpen());
  scene.server.tell({ told: "arming", id: 2 });
  await settle();
  assert.deepEqual(scene.log, ["arming"]);
  click(scene.window, "arm-yes");
  assert.deepEqual(scene.server.read(), [], "the code is used up");
});

test("a connection that is lost after the confirmation is logged", async () => {
  const scene = begin();
  await ask(scene);
  click(scene.window, "arm-yes");
  scene.server.close();
  await settle();
  assert.deepEqual(scene.log, ["no server"]);
});

test("a script's click is ignored", async () => {
  const scene = begin();
  await ask(scene);
  element("arm-yes").click();
  await settle();
  assert.deepEqual(scene.server.read(), []);
  assert.ok(isOpen());
});

test("the question ends exactly after its validity", async () => {
  const scene = begin();
  await ask(scene);
  mock.timers.tick(1000 * LASTS - 1);
  assert.ok(isOpen());
  mock.timers.tick(1);
  assert.ok(!isOpen());
  click(scene.window, "arm-yes");
  assert.deepEqual(scene.server.read(), [], "a late click has no code to confirm");
});

test("the timer of an answered question does not end the next one", async () => {
  const scene = begin();
  await ask(scene);
  mock.timers.tick(1000 * LASTS - 1);
  click(scene.window, "arm-no");
  await ask(scene, "4712");
  mock.timers.tick(1000);
  assert.ok(isOpen());
  click(scene.window, "arm-yes");
  assert.equal(scene.server.read()[0]!.code, "4712");
});

test("No, a closed dialog and a stop withdraw the question", async () => {
  const ends: ((scene: Scene) => void)[] = [
    ({ window }) => click(window, "arm-no"),
    () => element<HTMLDialogElement>("arming").close(),
    ({ arming }) => arming.end(),
  ];
  for (const end of ends) {
    const scene = begin();
    await ask(scene);
    end(scene);
    assert.ok(!isOpen());
    click(scene.window, "arm-yes");
    assert.deepEqual(scene.server.read(), []);
  }
});

test("the button shows the state and disarms only armed servos", () => {
  const button = () => element<HTMLButtonElement>("arm");
  const states = {
    limp: "Motors on …",
    arming: "Switching on",
    armed: "Motors off",
    releasing: "Switching off",
    ended: "Motors on …",
  };
  for (const [state, text] of Object.entries(states) as [ServoReport["state"], string][]) {
    const scene = begin(state);
    assert.equal(button().textContent, text);
    assert.equal(button().hidden, false);
    assert.equal(button().disabled, state === "arming" || state === "releasing", state);
    assert.equal(scene.arming.isTorqueOff, state !== "armed" && state !== "arming", state);
    click(scene.window, "arm");
    const asked = button().disabled ? undefined : state === "armed" ? "disarm" : "arm";
    assert.equal(scene.server.read()[0]?.do, asked, state);
  }
});

test("a simulated robot has no button, and nothing to switch on", () => {
  const { arming } = begin("limp");
  arming.show(null);
  assert.ok(element("arm").hidden);
  assert.equal(arming.isTorqueOff, false);
});

test("refusals, answers and a lost connection are logged", async () => {
  const scene = begin();
  click(scene.window, "arm");
  scene.server.tell({ told: "refused", id: 1, why: "the robot moves" });
  await settle();
  click(scene.window, "arm");
  scene.server.close();
  await settle();
  assert.deepEqual(scene.log, ["the robot moves", "no server"]);
  assert.ok(!isOpen());
  const armed = begin("armed");
  click(armed.window, "arm");
  armed.server.tell({ told: "releasing", id: 1 });
  await settle();
  assert.deepEqual(armed.log, ["releasing"]);
});
