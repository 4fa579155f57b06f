// Chart of the recording: a row per joint, time from left to right, a darker colour for a higher value.
import { computeStrain, type Measure } from "../telemetry.ts";
import type { Body, ServoPlace } from "../types.ts";
import type { Recording } from "./recording.ts";

const COLUMNS = 160; // time steps of the chart
const ROW_HEIGHT = 5; // [pixels]
const MIN_STRAIN = 0.02; // smallest value that is drawn

/** Draw one measure of all joints over a span [s] until an end time [s]; mark a time. */
export function drawHistory(
  canvas: HTMLCanvasElement,
  body: Body,
  recording: Recording,
  places: readonly ServoPlace[],
  view: { measure: Measure; end: number; span: number; marked: number },
): void {
  const rows = body.hinges.length;
  canvas.width = 2 * COLUMNS;
  canvas.height = rows * ROW_HEIGHT;
  const context = canvas.getContext("2d");
  if (!context || !recording.count) return;
  const colours = getComputedStyle(canvas);
  const begin = view.end - view.span;
  context.fillStyle = colours.getPropertyValue("--stroke");
  for (let column = 0; column < COLUMNS; column++) {
    const time = begin + (view.span * (column + 1)) / COLUMNS;
    const report = time < recording.begin ? null : recording.at(time);
    if (!report) continue;
    computeStrain(body, report, places, view.measure).forEach((strain, row) => {
      if (strain < MIN_STRAIN) return;
      context.globalAlpha = Math.min(1, 0.15 + 0.85 * strain);
      context.fillRect(2 * column, row * ROW_HEIGHT, 2, ROW_HEIGHT - 1);
    });
  }
  context.globalAlpha = 1;
  context.fillStyle = colours.getPropertyValue("--stop");
  const x = (2 * COLUMNS * (view.marked - begin)) / view.span;
  context.fillRect(Math.min(Math.max(x, 0), 2 * COLUMNS - 2), 0, 2, canvas.height);
}
