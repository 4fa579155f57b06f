// A page that is connected to the server of a robot, with a connection for stops.
import { Robot } from "../src/robot.ts";
import type { Body } from "../src/types.ts";
import { load, type Socket, sockets } from "./page.ts";

export const BODY = { hinges: ["l_elbow"] } as unknown as Body;
const servos = (state: string) => ({ state, celsius: [30], load: [0], volts: [12], errors: [0], torque: [1] });
/** Report of the robot; null: without servos. */
export const body = (state: string | null) => ({
  ...{ told: "body", time: 1, angles: [0.1], planned: [0.2], hottest: null, volts: null, faulty: false },
  servos: state === null ? null : servos(state),
});

export interface Scene {
  window: ReturnType<typeof load>;
  robot: Robot;
  line: Socket;
  stopLine: Socket;
  calls: string[];
}

/** Open the page with a connected server. */
export function begin(): Scene {
  const window = load();
  const calls: string[] = [];
  const listener = {
    opened: () => calls.push("opened"),
    changed: () => calls.push("changed"),
    moved: () => calls.push("moved"),
    heard: () => {},
    told: () => {},
  };
  const robot = new Robot(BODY, listener);
  const [line, stopLine] = sockets as [Socket, Socket];
  line.open();
  line.tell({ told: "status", state: "rest" });
  stopLine.open();
  stopLine.tell({ told: "stop_line" });
  return { window, robot, line, stopLine, calls };
}
