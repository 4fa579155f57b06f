// Whether what the server tells has the shape that the page relies on: what has not is passed over, as if nothing had been told.
import type { BodyReport, Draft, Reached } from "./types.ts";

type Told = Record<string, unknown>;

const isNumber = (value: unknown): boolean => Number.isFinite(value);
const areNumbers = (value: unknown, count: number, also: null[] = []): boolean =>
  Array.isArray(value) && value.length === count && value.every((each) => isNumber(each) || also.includes(each));
const areTexts = (value: unknown): boolean => Array.isArray(value) && value.every((each) => typeof each === "string");

/** The posture of a part that is dragged, of a robot with so many hinges; null where it is none. */
export function readReached(told: Told, hinges: number): Reached | null {
  const { angles, residual, limits, contact } = told;
  const whole = areNumbers(angles, hinges) && isNumber(residual) && areTexts(limits);
  return whole && (contact === null || areTexts(contact)) ? (told as unknown as Reached) : null;
}

/** How a robot with so many hinges is; null where that is not told. */
export function readReport(told: Told, hinges: number): BodyReport | null {
  const { angles, planned, servos } = told;
  const whole = areNumbers(planned, hinges) && areNumbers(angles, hinges, [null]) && typeof servos === "object";
  return whole && (servos === null || areServos(servos as Told)) ? (told as unknown as BodyReport) : null;
}

const areServos = ({ celsius, load, volts, errors, torque }: Told): boolean =>
  Array.isArray(celsius) &&
  [celsius, load, volts, errors, torque].every((each) => areNumbers(each, celsius.length, [null]));

const LISTS = ["behaviours", "syncs", "words", "phonemes", "notices"] as const;

/** What a document becomes; null where that is not told. */
export function readDraft(told: Told): Draft | null {
  const lists = LISTS.every((name) => Array.isArray(told[name]));
  const texts = ["block", "angles", "loudness"].every((name) => typeof told[name] === "string");
  const timed = [told.zero, told.rate, told.duration].every(isNumber) && Number(told.rate) > 0;
  return lists && texts && timed ? (told as unknown as Draft) : null;
}
