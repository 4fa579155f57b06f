// State of each servo as a strip and as a colour of the body.
import { byId, make, say } from "./dom.ts";
import type { Body, BodyReport, ServoPlace, ServoReport } from "./types.ts";

const MAX_TRACKING_ERROR = 0.1; // [rad] very large tracking error
const NORMAL_TEMPERATURE = 40; // [C] normal temperature
const BAR_STEPS = 50; // steps of a bar
const MAX_VOLTAGE_DROP = 1; // [V] very large drop below the best supplied servo
const ERROR_NAMES: Record<number, string> = {
  1: "voltage",
  4: "overheating",
  8: "encoder",
  16: "electrical shock",
  32: "overload",
};
export const MEASURES = ["tracking", "temperature", "load", "voltage", "error"] as const;
export type Measure = (typeof MEASURES)[number];

/** Return the names of a servo's error bits. */
export const errorWords = (bits: number): string =>
  Object.entries(ERROR_NAMES)
    .filter(([bit]) => bits & Number(bit))
    .map(([, word]) => word)
    .join(", ") || "error";

const clamp = (value: number): number => Math.min(1, Math.max(0, value));

/** Return the tracking error per joint, 1: very large; 0 while the servos have no torque and follow no plan. */
const tracking = ({ planned, angles, servos }: BodyReport): number[] =>
  planned.map((angle, k) =>
    servos?.state === "limp" ? 0 : clamp(Math.abs(angle - (angles[k] ?? angle)) / MAX_TRACKING_ERROR),
  );

/** Return one measure per servo, 1: at its limit. */
function ofServos(report: ServoReport, places: readonly ServoPlace[], measure: Measure): number[] {
  const best = Math.max(...report.volts.map((volts) => volts ?? 0));
  return places.map((place, k) => {
    const celsius = report.celsius[k];
    if (celsius == null) return 1; // no answer
    if (measure === "temperature") return clamp((celsius - NORMAL_TEMPERATURE) / (place.hottest - NORMAL_TEMPERATURE));
    if (measure === "load") return clamp(Math.abs(report.load[k] ?? 0));
    if (measure === "voltage") return clamp((best - (report.volts[k] ?? 0)) / MAX_VOLTAGE_DROP);
    return report.errors[k] ? 1 : 0;
  });
}

/** Return one measure per joint, the worst of its servos. */
export function computeStrain(
  body: Body,
  report: BodyReport,
  places: readonly ServoPlace[],
  measure: Measure,
): number[] {
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

const COLUMN_TITLES = ["", "away", "load", "°C", "V"];

/** Strips of all servos, or of all joints of a robot without servos. */
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
    const heads = places.length ? COLUMN_TITLES : ["", "away", "", "angle"];
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
    fill(strip.bars.load, clamp(Math.abs(load[k] ?? 0)));
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

/** Fill a bar in visible steps; smaller changes cause no repaint. */
function fill(bar: HTMLElement, fraction: number): void {
  const seen = (Math.round(BAR_STEPS * fraction) / BAR_STEPS).toString();
  if (bar.style.getPropertyValue("--share") !== seen) bar.style.setProperty("--share", seen);
}

const degrees = (angle: number | undefined): string =>
  angle == null ? "–" : `${Math.round((angle * 180) / Math.PI) || 0}°`; // not -0
