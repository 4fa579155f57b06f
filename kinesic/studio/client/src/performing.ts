// Clock of the running performance: feedback tells its start, reports of the robot its time.
import type { Feedback } from "./feedback.ts";
import { BLOCK, findAttribute, tagWithId } from "./xml.ts";

/** Beginnings of warnings about a block that does not start. */
const REFUSALS = ["rule ", "not performed", "revoked", "a block of this id", "it is for "] as const;
const MAX_AHEAD = 0.2; // [s] longest time that the clock runs on without a report

export class Performing {
  private block = ""; // empty: nothing is performed, or a block without id
  private isAsked = false; // whether a document was sent whose end is not known
  private begun: number | null = null; // [s] server time of the block's start
  private report = { time: 0, at: 0 }; // [s] server time and [ms] page time of the last report
  private ticks = false;

  /** `show` shows a time [s] of the performance, `say` its state in words. */
  constructor(
    private readonly show: (time: number) => void,
    private readonly say: (text: string) => void,
  ) {}

  /** Whether the block moves the robot. */
  get runs(): boolean {
    return this.begun !== null;
  }

  /** Whether a document was sent that may still be performed. */
  get waits(): boolean {
    return this.isAsked;
  }

  /** Tell that a document is prepared, before it is sent. */
  prepare(): void {
    this.say("Getting ready …");
  }

  /** Tell that the document is not performed; an earlier one may still run. */
  fail(): void {
    this.say("Not performed, see Messages");
  }

  /** Wait for the start of a document, which is the time 0 of its plan. */
  begin(bml: string): void {
    const root = tagWithId(bml, BLOCK);
    this.block = (root && findAttribute(root, "id")?.value) ?? "";
    this.begun = null;
    this.isAsked = true;
    if (this.block) this.prepare();
    else this.say("Sent to the robot"); // its start is not reported
  }

  end(): void {
    this.isAsked = false;
    this.block = "";
    this.begun = null;
    this.say("");
  }

  /** Take the start, the end or the refusal of the block from the feedback. */
  hear({ kind, about, time, text }: Feedback): void {
    const isRefusal = kind === "warningFeedback" && REFUSALS.some((beginning) => text.startsWith(beginning));
    if (isRefusal && this.block && about === this.block && !this.runs) this.fail();
    if (kind !== "blockProgress" || !this.block || time === null) return;
    if (about === `${this.block}:start`) {
      this.begun = time;
      this.report = { time, at: performance.now() };
      this.run();
    } else if (about === `${this.block}:end`) {
      this.end();
      this.show(Number.POSITIVE_INFINITY); // the end of the slider
      this.say("Finished");
    }
  }

  /** Take the server time [s] of a report. */
  reported(time: number): void {
    this.report = { time, at: performance.now() };
  }

  private run(): void {
    if (this.ticks) return;
    this.ticks = true;
    requestAnimationFrame(() => this.tick());
  }

  private tick(): void {
    this.ticks = false;
    if (this.begun === null) return;
    const ahead = Math.min((performance.now() - this.report.at) / 1000, MAX_AHEAD);
    const time = Math.max(0, this.report.time + ahead - this.begun);
    this.show(time);
    this.say(`Performing ${time.toFixed(1)} s`);
    this.run();
  }
}
