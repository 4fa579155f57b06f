// How each servo is, as a strip and as colour on the body.
import { byId, make, say } from "./dom.ts";
import type { Body, BodyReport, ServoPlace, ServoReport } from "./types.ts";

const WIDEST = 0.1; // [rad] of error that is very far
const COOL = 40; // [C] at which nothing is to be said
const STEPS = 50; // of a bar
const SAG = 1; // [V] below the best supplied servo that is very low
const ERRORS: Record<number, string> = {
  1: "voltage",
  4: "overheating",
  8: "encoder",
  16: "electrical shock",
  32: "overload",
};
export const MEASURES = ["tracking", "temperature", "load", "voltage", "error"] as const;
export type Measure = (typeof MEASURES)[number];

/** What the bits of a servo's error say. */
export const errorWords = (bits: number): string =>
  Object.entries(ERRORS)
    .filter(([bit]) => bits & Number(bit))
    .map(([, word]) => word)
    .join(", ") || "error";

const share = (value: number): number => Math.min(1, Math.max(0, value));

/** How far each hinge is from its plan, 1: very far. */
const tracking = ({ planned, angles }: BodyReport): number[] =>
  planned.map((angle, k) => share(Math.abs(angle - (angles[k] ?? angle)) / WIDEST));

/** One measure of each servo, 1: as bad as it may become. */
function ofServos(report: ServoReport, places: readonly ServoPlace[], measure: Measure): number[] {
  const best = Math.max(...report.volts.map((volts) => volts ?? 0));
  return places.map((place, k) => {
    const celsius = report.celsius[k];
    if (celsius == null) return 1; // it does not answer
    if (measure === "temperature") return share((celsius - COOL) / (place.hottest - COOL));
    if (measure === "load") return share(Math.abs(report.load[k] ?? 0));
    if (measure === "voltage") return share((best - (report.volts[k] ?? 0)) / SAG);
    return report.errors[k] ? 1 : 0;
  });
}

/** One measure of each hinge: of two servos that turn it the worse. */
export function strainOf(body: Body, report: BodyReport, places: readonly ServoPlace[], measure: Measure): number[] {
  if (measure === "tracking" || !report.servos) return tracking(report);
  const each = ofServos(report.servos, places, measure);
  return body.hinges.map((hinge) => Math.max(0, ...each.filter((_, k) => places[k]?.hinge === hinge)));
}

interface Strip {
  line: HTMLElement;
  hinge: number;
  bars: Record<"tracking" | "load", HTMLElement>;
  texts: HTMLElement[];
}

const COLUMNS = ["", "away", "load", "°C", "V"];

/** A strip for each servo; for each hinge where there are none. */
export class Strips {
  private strips: Strip[] = [];
  private places: readonly ServoPlace[] = [];

  constructor(private readonly body: Body) {
    this.list([]);
  }

  list(places: readonly ServoPlace[]): void {
    this.places = places;
    const names = places.length
      ? places.map((place) => ({
          name: place.hinge,
          title: `${place.hinge}: ${place.model} ${place.id} at ${place.bus}`,
        }))
      : this.body.hinges.map((name) => ({ name, title: name }));
    this.strips = names.map(({ name, title }) => this.strip(name, title));
    const heads = places.length ? COLUMNS : ["", "away", "", "angle"];
    const head = make(
      "div",
      { class: "strip head", "aria-hidden": "true" },
      ...heads.map((word) => make("span", {}, word)),
    );
    byId("strips").replaceChildren(head, ...this.strips.map(({ line }) => line));
  }

  show(report: BodyReport): void {
    const far = tracking(report);
    const { servos } = report;
    this.strips.forEach((strip, k) => {
      fill(strip.bars.tracking, far[strip.hinge] ?? 0);
      if (servos && this.places.length) this.tell(strip, servos, k);
      else say(strip.texts[0]!, degrees(report.angles[strip.hinge]));
    });
  }

  private tell(strip: Strip, servos: ServoReport, k: number): void {
    const { celsius, volts, errors, load } = servos;
    const bits = errors[k];
    fill(strip.bars.load, share(Math.abs(load[k] ?? 0)));
    say(strip.texts[0]!, celsius[k]?.toFixed(0) ?? "–");
    say(strip.texts[1]!, volts[k]?.toFixed(1) ?? "–");
    strip.line.classList.toggle("faulty", bits === null || Boolean(bits));
    say(strip.texts[2]!, bits === null ? "silent" : bits ? errorWords(bits!) : "");
  }

  private strip(name: string, title: string): Strip {
    const bars = { tracking: make("i"), load: make("i", { class: "load" }) };
    const texts = [0, 1].map(() => make("span", { class: "value" }));
    const error = make("span", { class: "error" });
    const line = make("div", { class: "strip", title }, make("span", { class: "hinge" }, name, error));
    line.append(bars.tracking, bars.load, ...texts);
    return { line, hinge: this.body.hinges.indexOf(name), bars, texts: [...texts, error] };
  }
}

/** Fills a share of a bar, in steps that are seen: what hardly changes is not painted anew. */
function fill(bar: HTMLElement, share: number): void {
  const seen = (Math.round(STEPS * share) / STEPS).toString();
  if (bar.style.getPropertyValue("--share") !== seen) bar.style.setProperty("--share", seen);
}

const degrees = (angle: number | undefined): string =>
  angle == null ? "–" : `${((angle * 180) / Math.PI).toFixed(0)}°`;
