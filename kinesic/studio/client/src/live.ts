// What the robot does now: a strip for each hinge, and what the server tells.
import { byId, make } from "./dom.ts";
import type { Body, BodyReport } from "./types.ts";

const KEPT = 60; // lines of the log
const WIDEST = 0.1; // [rad] of error, that fills a strip

/** How far each hinge is from its plan, as shares of `WIDEST`. */
export const strainOf = ({ planned, angles }: BodyReport): number[] =>
  planned.map((angle, k) => Math.min(1, Math.abs(angle - (angles[k] ?? angle)) / WIDEST));

export class Live {
  private readonly strips: { bar: HTMLElement; value: HTMLElement }[];
  private last = 0;

  constructor(private readonly body: Body) {
    this.strips = body.hinges.map((name) => {
      const bar = make("i");
      const value = make("span", { class: "value" });
      byId("strips").append(make("div", { class: "strip" }, make("span", { class: "hinge" }, name), bar, value));
      return { bar, value };
    });
  }

  show(report: BodyReport): void {
    if (performance.now() - this.last < 90 || !byId("live").checkVisibility()) return;
    this.last = performance.now();
    const strain = strainOf(report);
    this.body.hinges.forEach((_, k) => {
      const { bar, value } = this.strips[k]!;
      bar.style.setProperty("--share", String(strain[k]));
      value.textContent = `${((report.angles[k]! * 180) / Math.PI).toFixed(0)}°`;
    });
    const servos = [
      report.hottest === null ? "" : `${report.hottest.toFixed(0)} °C`,
      report.volts === null ? "" : `${report.volts.toFixed(1)} V`,
      report.faulty ? "a servo reports an error" : "",
    ];
    byId("servos").textContent = servos.filter(Boolean).join(", ") || "simulated";
  }

  /** BML feedback, shortened to what people ask. */
  feedback(xml: string): void {
    const root = new DOMParser().parseFromString(xml, "text/xml").documentElement;
    const about = root.getAttribute("id") ?? root.getAttribute("characterId") ?? "";
    const time = root.getAttribute("globalTime");
    this.say(`${root.localName}${about ? ` ${about}` : ""}${time ? ` ${Number(time).toFixed(2)} s` : ""}`, xml);
  }

  say(text: string, title = ""): void {
    const log = byId("log");
    log.prepend(make("li", { title }, text));
    while (log.children.length > KEPT) log.lastElementChild?.remove();
  }
}
