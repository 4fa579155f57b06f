// Button that records a gesture and opens it in the editor: from hands that are dragged on the stage, or from a robot
// without torque that is moved by hand.
import { toArmLengths } from "../arm_lengths.ts";
import { byId, say } from "../dom.ts";
import type { Place } from "../toml.ts";
import type { Body, BodyReport, Side } from "../types.ts";
import type { Vector } from "../vectors.ts";
import { type HandSample, writeGesture } from "./hand_motion.ts";

const GESTURE_NAME = "my_recording"; // id and file name of a recorded gesture
const MAX_DURATION = 30; // [s] after which a recording ends
const BUTTON_WORDS = "Record a motion"; // on the button while nothing is recorded

/** Source of the recorded postures, with a hint before the start, the origin of the gesture, and advice. */
const SOURCES = {
  plan: {
    hint: "drag the hands on the stage",
    origin: "recorded from hands that were dragged on the stage",
    advice: "no hand has moved; drag the hands on the stage",
  },
  robot: {
    hint: "move the arms of the robot",
    origin: "recorded from a robot that was moved by hand",
    advice: "no hand has moved; move the arms of the robot",
  },
} as const;
type Source = keyof typeof SOURCES;

/** Parts of the page that recording needs. */
export interface RecorderListener {
  /** Position [m] of a hand for joint angles [rad], by default for the shown ones; null without a scene. */
  hand(side: Side, angles?: readonly number[]): Vector | null;
  open(name: string, text: string): void;
  /** Whether a person can move the robot's arms, because its servos have no torque. */
  isMovedByHand(): boolean;
  /** Show the robot, or else the plan, whose hands can be dragged. */
  show(mode: Source): void;
}

export class GestureRecorder {
  private readonly button = byId<HTMLButtonElement>("record-gesture");
  private samples: HandSample[] | null = null; // null: not recording
  private source: Source = "plan";
  private begun = 0; // [s] time of the first sample, by the clock of the source

  constructor(
    private readonly body: Body,
    private readonly listener: RecorderListener,
  ) {
    this.button.addEventListener("click", () => (this.samples ? this.end() : this.begin()));
  }

  get isRecording(): boolean {
    return this.samples !== null;
  }

  /** Take the hands of a robot that is moved by hand. */
  addReport({ time, angles, planned }: BodyReport): void {
    if (!this.samples || this.source !== "robot") return;
    if (!this.samples.length) this.begun = time;
    this.add(
      angles.map((angle, k) => angle ?? planned[k]!),
      time,
    );
  }

  /** Take the hands of a posture [rad] that was dragged on the stage. */
  addDragged(angles: readonly number[]): void {
    if (!this.samples || this.source !== "plan") return;
    const time = performance.now() / 1000;
    if (this.samples.length === 1) this.begun = time; // the first sample is the posture before the drag
    this.add(angles, time);
  }

  private add(angles: readonly number[] | undefined, time: number): void {
    const [left, right] = [this.place("left", angles), this.place("right", angles)];
    if (left && right) this.samples?.push({ left, right });
    say(byId("record-status"), `recording ${(time - this.begun).toFixed(1)} s`);
    if (time - this.begun >= MAX_DURATION) this.end();
  }

  private place(side: Side, angles: readonly number[] | undefined): Place | null {
    const position = this.listener.hand(side, angles);
    return position && toArmLengths(this.body, side, position);
  }

  private begin(): void {
    this.source = this.listener.isMovedByHand() ? "robot" : "plan";
    this.samples = [];
    this.listener.show(this.source);
    if (this.source === "plan") this.add(undefined, this.begun);
    say(this.button, "End recording");
    say(byId("record-status"), `recording: ${SOURCES[this.source].hint}`);
  }

  private end(): void {
    const samples = this.samples ?? [];
    const { origin, advice } = SOURCES[this.source];
    this.samples = null;
    say(this.button, BUTTON_WORDS);
    const text = samples.length ? writeGesture(GESTURE_NAME, samples, origin) : null;
    say(byId("record-status"), text ? "" : advice);
    if (text) this.listener.open(`${GESTURE_NAME}.toml`, text);
  }
}
