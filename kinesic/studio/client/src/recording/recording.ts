// Reports of the robot of the last two minutes, and their table for export.
import type { BodyReport, ServoPlace } from "../types.ts";

export const MAX_DURATION = 120; // [s] of the kept reports
const SERVO_COLUMNS = ["load", "celsius", "volts", "errors", "torque"] as const;

export class Recording {
  private reports: BodyReport[] = [];

  /** Add a report, and drop those that are too old; a clock that goes back begins a new recording. */
  add(report: BodyReport): void {
    const last = this.reports.at(-1);
    if (last && report.time < last.time) this.reports = [];
    this.reports.push(report);
    const first = this.reports.findIndex(({ time }) => time >= report.time - MAX_DURATION);
    if (first > 0) this.reports.splice(0, first);
  }

  get count(): number {
    return this.reports.length;
  }

  /** Time [s] of the first report. */
  get begin(): number {
    return this.reports[0]?.time ?? 0;
  }

  /** Time [s] of the last report. */
  get end(): number {
    return this.reports.at(-1)?.time ?? 0;
  }

  /** Return the last report at or before a time [s], or the first one. */
  at(time: number): BodyReport | null {
    let [low, high] = [0, this.reports.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.reports[middle]!.time <= time) low = middle + 1;
      else high = middle;
    }
    return this.reports[Math.max(low - 1, 0)] ?? null;
  }

  /** Return all reports as comma-separated values: angles [deg] of all joints, and the state of all servos. */
  table(hinges: readonly string[], places: readonly ServoPlace[]): string {
    const servos = places.map(({ hinge, bus, id }) => `${hinge}_${bus}_${id}`);
    const header = [
      "time_s",
      ...hinges.map((name) => `${name}_planned_deg`),
      ...hinges.map((name) => `${name}_measured_deg`),
      ...SERVO_COLUMNS.flatMap((column) => servos.map((name) => `${name}_${column}`)),
    ];
    const rows = this.reports.map(({ time, planned, angles, servos: state }) => [
      time.toFixed(3),
      ...planned.map(degrees),
      ...angles.map(degrees),
      ...SERVO_COLUMNS.flatMap((column) => places.map((_, k) => state?.[column][k] ?? "")),
    ]);
    return `${[header, ...rows].map((row) => row.join(",")).join("\n")}\n`;
  }
}

/** Format an angle in degrees; empty for a servo that does not answer. */
const degrees = (angle: number | null): string => (angle === null ? "" : ((angle * 180) / Math.PI).toFixed(2));
