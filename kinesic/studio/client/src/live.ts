// Live state of the robot and messages of the server.
import { byId, make, say } from "./dom.ts";
import type { Feedback } from "./feedback.ts";
import { progressWords } from "./plain_words.ts";
import { Strips } from "./telemetry.ts";
import type { Body, BodyReport, ServoPlace, ServoReport } from "./types.ts";

const STATE_WORDS: Record<ServoReport["state"], string> = {
  limp: "motors off",
  arming: "switching on",
  armed: "motors on",
  releasing: "switching off",
  ended: "motors off",
};
const MIN_INTERVAL = 90; // [ms] between two updates of the strips
const MAX_LOG_LINES = 60; // lines of the log

export class Live {
  private readonly strips: Strips;
  private last = 0;

  constructor(body: Body) {
    this.strips = new Strips(body);
  }

  list(places: readonly ServoPlace[]): void {
    this.strips.list(places);
  }

  /** Show a report, at most every `MIN_INTERVAL` unless it is forced. */
  show(report: BodyReport, isForced = false): void {
    const isEarly = performance.now() - this.last < MIN_INTERVAL && !isForced;
    if (isEarly || !byId("live").checkVisibility()) return;
    this.last = performance.now();
    this.strips.show(report);
    const servos = [
      report.servos ? STATE_WORDS[report.servos.state] : "",
      report.hottest === null ? "" : `${report.hottest.toFixed(0)} °C`,
      report.volts === null ? "" : `${report.volts.toFixed(1)} V`,
      report.faulty ? "a motor reports a fault" : "",
    ];
    say(byId("servos"), servos.filter(Boolean).join(", ") || "simulated");
  }

  /** Log BML feedback in short form, with its XML as the title. */
  feedback({ kind, about, time, text }: Feedback, xml: string): void {
    const words = kind === "warningFeedback" ? `${about}: ${text}` : progressWords(kind, about);
    this.say(`${words}${time === null ? "" : ` at ${time.toFixed(2)} s`}`, xml);
  }

  say(text: string, title = ""): void {
    const log = byId("log");
    log.prepend(make("li", { title }, text));
    while (log.children.length > MAX_LOG_LINES) log.lastElementChild?.remove();
  }
}
