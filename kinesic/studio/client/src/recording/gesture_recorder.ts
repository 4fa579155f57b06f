// Button that records a gesture from a robot that is moved by hand, and opens it in the editor.
import { toArmLengths } from "../arm_lengths.ts";
import { byId, say } from "../dom.ts";
import type { Place } from "../toml.ts";
import type { Body, BodyReport, Side } from "../types.ts";
import type { Vector } from "../vectors.ts";
import { type HandSample, writeGesture } from "./hand_motion.ts";

const GESTURE_NAME = "my_recording"; // id and file name of a recorded gesture
const MAX_DURATION = 30; // [s] after which a recording ends

/** Parts of the page that recording needs. */
export interface RecorderListener {
  /** Position [m] of a hand for joint angles [rad]; null without a scene. */
  hand(side: Side, angles: readonly number[]): Vector | null;
  open(name: string, text: string): void;
  showRobot(): void;
}

export class GestureRecorder {
  private readonly button = byId<HTMLButtonElement>("record-gesture");
  private samples: HandSample[] | null = null; // null: not recording
  private begun = 0; // [s] server time of the first sample

  constructor(
    private readonly body: Body,
    private readonly listener: RecorderListener,
  ) {
    this.button.addEventListener("click", () => (this.samples ? this.end() : this.begin()));
  }

  /** Take the hands of a report while recording. */
  add({ time, angles, planned }: BodyReport): void {
    if (!this.samples) return;
    if (!this.samples.length) this.begun = time;
    const measured = angles.map((angle, k) => angle ?? planned[k]!);
    const [left, right] = [this.place("left", measured), this.place("right", measured)];
    if (left && right) this.samples.push({ left, right });
    say(byId("record-status"), `recording ${(time - this.begun).toFixed(1)} s`);
    if (time - this.begun >= MAX_DURATION) this.end();
  }

  private place(side: Side, angles: readonly number[]): Place | null {
    const position = this.listener.hand(side, angles);
    return position && toArmLengths(this.body, side, position);
  }

  private begin(): void {
    this.samples = [];
    this.listener.showRobot();
    say(this.button, "End recording");
    say(byId("record-status"), "recording");
  }

  private end(): void {
    const samples = this.samples ?? [];
    this.samples = null;
    say(this.button, "Record by hand");
    const text = samples.length ? writeGesture(GESTURE_NAME, samples) : null;
    say(byId("record-status"), text ? "" : "no hand has moved; switch the motors off and move the arms");
    if (text) this.listener.open(`${GESTURE_NAME}.toml`, text);
  }
}
