// Connections: separate stop line, reconnection, and matching of answers to requests.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { type Answer, type State, Wire } from "../src/wire.ts";
import { load, type Socket, settle, sockets } from "./page.ts";

interface Scene {
  wire: Wire;
  line: Socket;
  stopLine: Socket;
  states: State[];
  told: Answer[];
  feedback: string[];
}

/** Connect both lines to a server that has not answered yet. */
function begin(token: string | null = null, url?: string): Scene {
  load(url);
  const scene = { states: [] as State[], told: [] as Answer[], feedback: [] as string[] };
  const listener = {
    state: (state: State) => scene.states.push(state),
    told: (answer: Answer) => scene.told.push(answer),
    feedback: (xml: string) => scene.feedback.push(xml),
  };
  const wire = new Wire(listener, token);
  const [line, stopLine] = sockets as [Socket, Socket];
  return { wire, line, stopLine, ...scene };
}

function open(scene: Scene): Scene {
  scene.line.open();
  scene.line.tell({ told: "status", state: "rest" });
  scene.stopLine.open();
  scene.stopLine.tell({ told: "stop_line" });
  scene.line.read();
  scene.stopLine.read();
  return scene;
}

test("two connections go to the page's host, with TLS for an https page", () => {
  begin();
  assert.deepEqual(
    sockets.map((socket) => socket.url),
    ["ws://robot.example:8080/", "ws://robot.example:8080/"],
  );
  begin(null, "https://robot.example/");
  assert.equal(sockets[0]!.url, "wss://robot.example/");
});

test("without a token the line requests the status; with one, both lines send it first", () => {
  const open = begin();
  open.line.open();
  open.stopLine.open();
  assert.deepEqual(open.line.read(), [{ do: "status" }]);
  assert.deepEqual(open.stopLine.read(), [{ do: "stop_line" }]);
  const locked = begin("secret");
  locked.line.open();
  locked.stopLine.open();
  assert.deepEqual(locked.line.read(), [{ do: "hello", token: "secret" }]);
  assert.deepEqual(locked.stopLine.read(), [{ do: "hello", token: "secret" }, { do: "stop_line" }]);
});

test("a stop uses the stop line after the server has granted it", () => {
  const scene = open(begin());
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.stopLine.read(), [{ do: "stop" }]);
  assert.deepEqual(scene.line.read(), [], "not by the line that documents may fill");
});

test("a stop uses the document line while the stop line is not granted or lost", () => {
  const scene = begin();
  scene.line.open();
  scene.stopLine.open();
  scene.line.read();
  scene.stopLine.read();
  scene.stopLine.tell({ told: "refused", why: "one stop line is enough" });
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.line.read(), [{ do: "stop" }]);
  scene.stopLine.tell({ told: "stop_line" });
  scene.stopLine.close();
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.line.read(), [{ do: "stop" }]);
  assert.deepEqual(scene.stopLine.read(), []);
});

test("other messages do not revoke a granted stop line", () => {
  const scene = open(begin());
  scene.stopLine.tell({ told: "stopped" });
  scene.stopLine.tell("no JSON");
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.stopLine.read(), [{ do: "stop" }]);
});

test("a reopened stop line is not used before it is granted again", async () => {
  const scene = open(begin());
  scene.stopLine.close();
  mock.timers.tick(300);
  const again = sockets[2]!;
  again.open();
  again.read();
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.line.read(), [{ do: "stop" }]);
  again.tell({ told: "stop_line" });
  assert.ok(scene.wire.stop());
  assert.deepEqual(again.read(), [{ do: "stop" }]);
});

test("a stop without any open line is reported as not sent", () => {
  const scene = open(begin());
  scene.line.close();
  scene.stopLine.close();
  assert.equal(scene.wire.stop(), false);
});

test("a granted stop line that cannot send falls back to the document line", () => {
  const scene = open(begin());
  scene.stopLine.readyState = 2; // closing, not yet closed
  assert.ok(scene.wire.stop());
  assert.deepEqual(scene.line.read(), [{ do: "stop" }]);
});

test("the stop line reports only stops and failures", () => {
  const scene = open(begin());
  for (const told of ["stopped", "failed", "status", "body"]) scene.stopLine.tell({ told });
  assert.deepEqual(
    scene.told.filter(({ told }) => told !== "status"),
    [{ told: "stopped" }, { told: "failed" }],
  );
  assert.equal(scene.told.length, 3, "the one status came by the other line");
});

test("answers are matched to requests by number, and others go to the listener", async () => {
  const scene = open(begin());
  scene.told.length = 0;
  const answers = [scene.wire.ask("plan", { bml: "a" }), scene.wire.ask("reach", {})];
  assert.deepEqual(scene.line.read(), [
    { do: "plan", id: 1, bml: "a" },
    { do: "reach", id: 2 },
  ]);
  scene.line.tell({ told: "reach", id: 2 });
  scene.line.tell({ told: "plan", id: 1 });
  assert.deepEqual(await Promise.all(answers), [
    { told: "plan", id: 1 },
    { told: "reach", id: 2 },
  ]);
  for (const unasked of [{ told: "plan", id: 1 }, { told: "gone", id: 9 }, { told: "stopped" }])
    scene.line.tell(unasked);
  assert.deepEqual(scene.told, [{ told: "plan", id: 1 }, { told: "gone", id: 9 }, { told: "stopped" }]);
});

test("a request returns null if the line is or becomes closed", async () => {
  const scene = open(begin());
  const waiting = scene.wire.ask("plan", {});
  scene.line.close();
  assert.equal(await waiting, null);
  assert.equal(await scene.wire.ask("plan", {}), null);
  assert.equal(scene.wire.perform("<bml/>"), false);
  assert.equal(scene.wire.tell("resume"), false);
});

test("documents are sent unchanged, control messages as JSON", () => {
  const scene = open(begin());
  assert.ok(scene.wire.perform("<bml/>"));
  assert.ok(scene.wire.tell("watch", { rate: 20 }));
  assert.deepEqual(scene.line.sent, ["<bml/>", '{"do":"watch","rate":20}']);
});

test("feedback, invalid answers and broken text are distinguished", () => {
  const scene = open(begin());
  scene.told.length = 0;
  scene.line.tell("<blockProgress/>");
  for (const broken of ["{", "{}x", "null", "7"]) scene.line.tell(broken);
  assert.deepEqual(scene.feedback, ["<blockProgress/>", "null", "7"]);
  assert.deepEqual(scene.told, []);
  for (const other of ["null", "7", "["]) scene.stopLine.tell(other);
  assert.deepEqual(scene.told, []);
});

test("the state follows welcome, first status, refused token and connection loss", async () => {
  const scene = begin("wrong");
  scene.line.open();
  scene.line.tell({ told: "refused", why: "another token" });
  assert.equal(scene.wire.state, "locked");
  scene.line.close();
  assert.equal(scene.wire.state, "locked", "it still needs a token");
  const other = begin("right");
  other.line.open();
  other.line.tell({ told: "refused", why: "too many documents" });
  assert.equal(other.wire.state, "connecting");
  other.line.tell({ told: "welcome" });
  other.line.tell({ told: "status" });
  assert.deepEqual(other.states, ["open"], "told once");
  other.line.close();
  assert.deepEqual(other.states, ["open", "closed"]);
});

test("a closed line reconnects after 0.3, 0.6, 1.2, 2.4 s, then every 4 s, and after success from 0.3 s", () => {
  const scene = begin();
  scene.stopLine.open();
  for (const wait of [300, 600, 1200, 2400, 4000, 4000]) {
    const count = sockets.length;
    latest().close();
    mock.timers.tick(wait - 1);
    assert.equal(sockets.length, count, `not before ${wait} ms`);
    mock.timers.tick(1);
    assert.equal(sockets.length, count + 1, `after ${wait} ms`);
  }
  latest().open();
  latest().close();
  const count = sockets.length;
  mock.timers.tick(300);
  assert.equal(sockets.length, count + 1);

  /** Last socket of the document line, while the stop line stays open. */
  function latest(): Socket {
    return sockets.length === 2 ? sockets[0]! : sockets.at(-1)!;
  }
});

test("a new token is sent at once, and waiting lines connect immediately, once", async () => {
  const scene = begin("old");
  scene.line.open();
  scene.line.read();
  scene.stopLine.close();
  scene.wire.unlock("new");
  assert.deepEqual(scene.line.read(), [{ do: "hello", token: "new" }]);
  assert.equal(sockets.length, 3, "the stop line, which waited, and not the open one");
  sockets[2]!.open();
  assert.deepEqual(sockets[2]!.read(), [{ do: "hello", token: "new" }, { do: "stop_line" }]);
  mock.timers.tick(10_000);
  assert.equal(sockets.length, 3, "its own attempt is not made again");
  scene.line.close();
  scene.wire.unlock("newer");
  assert.equal(sockets.length, 4);
  await settle();
});
