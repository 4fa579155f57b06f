// Newest plan of the document, and the text that it was made from.
import { byId, say } from "./dom.ts";
import { Drafting } from "./drafting.ts";
import type { Draft, Fault } from "./types.ts";
import type { Answer } from "./wire.ts";

/** Parts of the page that planning needs. */
export interface PlanListener {
  text(): string;
  /** Request the plan of the present document from the server. */
  request(): Promise<Answer | null>;
  /** A new plan has arrived. */
  planned(draft: Draft): void;
  /** The document has an error, and the former plan stays. */
  failed(fault: Fault): void;
}

export class PlannedDocument {
  /** Shown plan; null before the first one. */
  draft: Draft | null = null;
  /** Number of plans that were shown. */
  count = 0;
  /** Text from which the shown plan was made. */
  text = "";
  private requestedText = "";
  private readonly drafting: Drafting;

  constructor(private readonly listener: PlanListener) {
    this.drafting = new Drafting(() => this.request(), {
      waiting: (on) => say(byId("planning"), on ? "planning …" : ""),
      drafted: (draft) => this.show(draft),
      failed: (fault) => listener.failed(fault),
    });
  }

  /** Performance time [s] of block time 0. */
  get zero(): number {
    return this.draft?.zero ?? 0;
  }

  /** Whether the shown plan is that of the present document. */
  get isCurrent(): boolean {
    return this.draft !== null && this.text === this.listener.text();
  }

  /** Plan after a pause in typing. */
  later(): void {
    this.drafting.later();
  }

  /** Plan at once, or after a pause while the plan of an earlier change is awaited. */
  soon(): void {
    this.drafting.soon();
  }

  now(): void {
    void this.drafting.now();
  }

  private request(): Promise<Answer | null> {
    this.requestedText = this.listener.text();
    return this.listener.request();
  }

  private show(draft: Draft): void {
    this.draft = draft;
    this.count += 1;
    this.text = this.requestedText;
    this.listener.planned(draft);
  }
}
