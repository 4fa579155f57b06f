// Robot behind the server: connection, state, stop and messages.
import { Arming } from "./arming.ts";
import { readReport } from "./checks.ts";
import { byId } from "./dom.ts";
import { type Feedback, readFeedback } from "./feedback.ts";
import { Live } from "./live.ts";
import type { Body, BodyReport, ServoPlace } from "./types.ts";
import { type Answer, Wire } from "./wire.ts";

const REPORT_RATE = 20; // [Hz] rate of reports
const STATE_LABELS = { connecting: "connecting", open: "connected", locked: "token needed", closed: "no server" };
const STOPPED_RULE = "rule stopped"; // begins the warning that a block waits for Resume
const TOKEN_KEY = "token"; // key of the token in the session storage

export class Robot {
  readonly wire: Wire;
  readonly live: Live;
  report: BodyReport | null = null;
  /** Earlier report that is shown instead of the present one, or null. */
  earlier: BodyReport | null = null;
  stopped = false;
  /** Servos; empty for a simulated robot. */
  places: readonly ServoPlace[] = [];
  private readonly arming: Arming;
  // Stryker disable next-line BooleanLiteral: a new connection sets the value before it is read
  private isResting = false; // whether the server said that nothing moves, and nothing has begun since

  constructor(
    private readonly body: Body,
    private readonly listener: {
      opened(): void;
      changed(): void;
      moved(): void;
      heard(feedback: Feedback): void;
      told(answer: Answer): void;
    },
  ) {
    this.live = new Live(body);
    this.wire = new Wire(
      {
        state: () => this.connected(),
        told: (answer) => this.told(answer),
        feedback: (xml) => {
          const feedback = readFeedback(xml);
          this.live.feedback(feedback, xml);
          if (feedback.kind === "blockProgress") this.isResting = false;
          if (feedback.text.startsWith(STOPPED_RULE)) this.askState(); // servos may hold without a stop by a person
          this.listener.heard(feedback);
        },
      },
      sessionStorage.getItem(TOKEN_KEY),
    );
    this.arming = new Arming(
      this.wire,
      () => sessionStorage.getItem(TOKEN_KEY),
      (text) => this.live.say(text),
    );
  }

  /** Report that the page shows. */
  get shown(): BodyReport | null {
    return this.earlier ?? this.report;
  }

  /** Show an earlier report; null: the present one again. */
  look(earlier: BodyReport | null): void {
    this.earlier = earlier;
    if (this.shown) this.live.show(this.shown, true);
  }

  /** Whether documents can be performed. */
  get ready(): boolean {
    return this.obstacle === null;
  }

  /** Why no document can be performed now, with the remedy; null if one can. */
  get obstacle(): { why: string; remedy: string } | null {
    const { state } = this.wire;
    if (state !== "open") return { why: STATE_LABELS[state], remedy: "The page needs a connection to the robot" };
    if (this.stopped) return { why: "stopped", remedy: "Press Resume first" };
    return this.isTorqueOff ? { why: "motors off", remedy: "Switch the motors on first" } : null;
  }

  /** Whether the servos have no torque. */
  get isTorqueOff(): boolean {
    return this.arming.isTorqueOff;
  }

  /** Whether surely nothing moves or has torque; false while that is unknown. */
  get rests(): boolean {
    return this.wire.state === "open" && this.isResting && this.report !== null && this.arming.rests;
  }

  /** Ask whether the robot rests. */
  askState(): void {
    this.wire.tell("status");
  }

  stop(): void {
    this.arming.end();
    if (!this.wire.stop()) this.live.say("no server: use the switch that cuts its power");
  }

  resume(): void {
    this.wire.tell("resume");
    this.halt(false);
  }

  unlock(token: string): void {
    sessionStorage.setItem(TOKEN_KEY, token);
    this.wire.unlock(token);
  }

  private connected(): void {
    const { state } = this.wire;
    this.isResting = false;
    document.body.dataset.state = state;
    byId("state").textContent = STATE_LABELS[state];
    byId<HTMLDialogElement>("lock")[state === "locked" ? "show" : "close"]();
    byId<HTMLButtonElement>("stop").disabled = state !== "open";
    if (state === "open") {
      this.wire.tell("watch", { rate: REPORT_RATE });
      this.wire.tell("status");
      void this.list();
      this.listener.opened();
    }
    this.listener.changed();
  }

  private async list(): Promise<void> {
    const answer = await this.wire.ask("servos", {});
    this.places = (answer?.servos as ServoPlace[] | undefined) ?? [];
    this.live.list(this.places);
  }

  private told(answer: Answer): void {
    this.listener.told(answer);
    if (answer.told === "body") {
      const report = readReport(answer, this.body.hinges.length);
      if (!report) return;
      this.report = report;
      const { isTorqueOff } = this;
      this.arming.show(report.servos);
      if (isTorqueOff !== this.isTorqueOff) this.listener.changed();
      if (!this.earlier) this.live.show(report);
      this.listener.moved();
    } else if (answer.told === "stopped" || answer.told === "failed") {
      this.halt(true);
      this.live.say(String(answer.why ?? "stopped: the robot holds its posture"));
    } else if (answer.told === "status") {
      this.isResting = answer.state === "resting";
      this.halt(answer.state === "stopped");
    } else if (answer.told === "refused") this.live.say(String(answer.why));
  }

  private halt(stopped: boolean): void {
    this.stopped = stopped;
    if (stopped) this.isResting = false;
    document.body.classList.toggle("stopped", stopped);
    byId("resume").hidden = !stopped;
    this.listener.changed();
  }
}
