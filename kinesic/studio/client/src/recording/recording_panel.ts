// Telemetry over time: a chart of the last two minutes that is scrubbed, and its export.
import { byId, make, say } from "../dom.ts";
import type { Measure } from "../telemetry.ts";
import type { Body, BodyReport, ServoPlace } from "../types.ts";
import { drawHistory } from "./history_chart.ts";
import { MAX_DURATION, Recording } from "./recording.ts";

const DRAW_INTERVAL = 500; // [ms] between two drawings of the chart
const MIN_SPAN = 20; // [s] shortest duration of the chart
const FILE_NAME = "recording.csv";

/** Parts of the page that the recording needs. */
export interface RecordingListener {
  places(): readonly ServoPlace[];
  /** Show an earlier report instead of the present one; null: the present one again. */
  show(report: BodyReport | null): void;
  say(text: string): void;
}

export class RecordingPanel {
  private readonly recording = new Recording();
  private readonly canvas = byId<HTMLCanvasElement>("history-chart");
  private readonly slider = byId<HTMLInputElement>("history-time");
  private end: number | null = null; // [s] right edge of the chart while an earlier time is shown
  private span = MIN_SPAN; // [s] duration of the chart
  private drawn = 0; // [ms] time of the last drawing

  constructor(
    private readonly body: Body,
    private readonly listener: RecordingListener,
  ) {
    this.slider.addEventListener("input", () => this.scrub(Number(this.slider.value)));
    byId("history-live").addEventListener("click", () => this.scrub(0));
    byId("history-save").addEventListener("click", () => this.save());
    byId("measure").addEventListener("change", () => this.draw());
    for (const kind of ["pointerdown", "pointermove"] as const)
      this.canvas.addEventListener(kind, (event) => {
        if (kind === "pointerdown") this.canvas.setPointerCapture(event.pointerId);
        if (event.buttons & 1) this.scrub(this.timeAt(event.clientX));
      });
  }

  add(report: BodyReport): void {
    this.recording.add(report);
    if (performance.now() - this.drawn < DRAW_INTERVAL || !this.canvas.checkVisibility()) return;
    this.draw();
  }

  /** Duration [s] of the chart: that of the recording within limits; it stays while an earlier time is shown. */
  private measureSpan(): number {
    if (this.end !== null) return this.span;
    this.span = Math.min(Math.max(this.recording.end - this.recording.begin, MIN_SPAN), MAX_DURATION);
    this.slider.min = String(-this.span);
    return this.span;
  }

  private timeAt(x: number): number {
    const area = this.canvas.getBoundingClientRect();
    return Math.min(0, this.span * ((x - area.left) / Math.max(1, area.width) - 1));
  }

  /** Show the robot some seconds before the end of the chart (negative); 0: now. */
  private scrub(before: number): void {
    const isLive = before >= 0;
    this.end = isLive ? null : (this.end ?? this.recording.end);
    const report = this.end === null ? null : this.recording.at(this.end + before);
    this.slider.value = String(before);
    byId<HTMLButtonElement>("history-live").disabled = isLive;
    this.listener.show(report);
    this.draw();
  }

  private draw(): void {
    this.drawn = performance.now();
    const end = this.end ?? this.recording.end;
    const before = Number(this.slider.value);
    const measure = byId<HTMLSelectElement>("measure").value as Measure;
    drawHistory(this.canvas, this.body, this.recording, this.listener.places(), {
      measure,
      end,
      span: this.measureSpan(),
      marked: end + before,
    });
    const words = before < 0 ? `${Math.abs(before).toFixed(1)} s earlier` : "now";
    this.slider.setAttribute("aria-valuetext", words);
    say(byId("history-status"), `${words}; ${(this.recording.end - this.recording.begin).toFixed(0)} s recorded`);
  }

  /** Download the recording as a table. */
  private save(): void {
    const table = this.recording.table(this.body.hinges, this.listener.places());
    const address = URL.createObjectURL(new Blob([table], { type: "text/csv" }));
    make("a", { href: address, download: FILE_NAME }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
    this.listener.say(`exported: ${FILE_NAME}, ${this.recording.count} rows`);
  }
}
