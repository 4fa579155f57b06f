// Asks the server what a document becomes: once nobody has typed for a moment, and the newest answer alone counts.
import type { Draft, Fault } from "./types.ts";
import type { Answer } from "./wire.ts";

const IDLE = 150; // [ms] after the last change

export class Drafting {
  private timer = 0;
  private asked = 0;

  constructor(
    private readonly ask: () => Promise<Answer | null>,
    private readonly listener: { drafted(draft: Draft): void; failed(fault: Fault): void },
  ) {}

  /** Asks soon, unless it is told so again before. */
  later(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.now(), IDLE);
  }

  async now(): Promise<void> {
    const number = ++this.asked;
    const answer = await this.ask();
    if (!answer || number !== this.asked || answer.outdated) return;
    if (answer.error) this.listener.failed(answer.error as Fault);
    else this.listener.drafted(answer as unknown as Draft);
  }
}
