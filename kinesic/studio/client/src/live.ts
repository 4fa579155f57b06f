// Live state of the robot and messages of the server.
import { byId, make, say } from "./dom.ts";
import type { Feedback } from "./feedback.ts";
import { Strips } from "./telemetry.ts";
import type { Body, BodyReport, ServoPlace } from "./types.ts";

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
      report.servos?.state ?? "",
      report.hottest === null ? "" : `${report.hottest.toFixed(0)} °C`,
      report.volts === null ? "" : `${report.volts.toFixed(1)} V`,
      report.faulty ? "a servo reports an error" : "",
    ];
    say(byId("servos"), servos.filter(Boolean).join(", ") || "simulated");
  }

  /** Log BML feedback in short form. */
  feedback({ kind, about, time, text }: Feedback, xml: string): void {
    const what = kind === "warningFeedback" ? `: ${text}` : "";
    this.say(`${kind}${about ? ` ${about}` : ""}${time === null ? "" : ` ${time.toFixed(2)} s`}${what}`, xml);
  }

  say(text: string, title = ""): void {
    const log = byId("log");
    log.prepend(make("li", { title }, text));
    while (log.children.length > MAX_LOG_LINES) log.lastElementChild?.remove();
  }
}
