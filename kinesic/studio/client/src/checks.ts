// Checks of answers from the server; an answer of another shape is ignored.
import type { BodyReport, Draft, Reached } from "./types.ts";

type Message = Record<string, unknown>;

const isNumber = (value: unknown): boolean => Number.isFinite(value);
const areNumbers = (value: unknown, count: number, also: null[] = []): boolean =>
  Array.isArray(value) && value.length === count && value.every((each) => isNumber(each) || also.includes(each));
const areStrings = (value: unknown): boolean => Array.isArray(value) && value.every((each) => typeof each === "string");

/** Return the reached posture of a drag for a number of joints, or null if the answer is invalid. */
export function readReached(told: Message, hinges: number): Reached | null {
  const { angles, residual, limits, contact } = told;
  const whole = areNumbers(angles, hinges) && isNumber(residual) && areStrings(limits);
  return whole && (contact === null || areStrings(contact)) ? (told as unknown as Reached) : null;
}

/** Return the report of the robot for a number of joints, or null if the answer is invalid. */
export function readReport(told: Message, hinges: number): BodyReport | null {
  const { angles, planned, servos } = told;
  const whole = areNumbers(planned, hinges) && areNumbers(angles, hinges, [null]) && typeof servos === "object";
  return whole && (servos === null || areServos(servos as Message)) ? (told as unknown as BodyReport) : null;
}

const areServos = ({ celsius, load, volts, errors, torque }: Message): boolean =>
  Array.isArray(celsius) &&
  [celsius, load, volts, errors, torque].every((each) => areNumbers(each, celsius.length, [null]));

const LISTS = ["behaviours", "syncs", "words", "phonemes", "accents", "notices"] as const;
const isBehaviour = ({ id, label, tracks }: Message): boolean => areStrings([id, label]) && areStrings(tracks);

/** Return the draft of a document, or null if the answer is invalid. */
export function readDraft(told: Message): Draft | null {
  const lists = LISTS.every((name) => Array.isArray(told[name]));
  const texts = ["block", "angles", "loudness"].every((name) => typeof told[name] === "string");
  const timed = [told.zero, told.rate, told.duration].every(isNumber) && Number(told.rate) > 0;
  const named = lists && (told.behaviours as Message[]).every(isBehaviour);
  return named && texts && timed ? (told as unknown as Draft) : null;
}
