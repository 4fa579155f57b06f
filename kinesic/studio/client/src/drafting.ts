// Asks the server what a document becomes: once nobody has typed for a moment, and the newest answer alone counts.
import { readDraft } from "./checks.ts";
import type { Draft, Fault } from "./types.ts";
import type { Answer } from "./wire.ts";

const UNREAD: Fault = { line: 1, column: 1, text: "the server's answer cannot be read: is it of another version?" };
const IDLE = 150; // [ms] after the last change
const LONG = 400; // [ms] without an answer, after which it is said that one is awaited

export class Drafting {
  private timer = 0;
  private asked = 0;

  constructor(
    private readonly ask: () => Promise<Answer | null>,
    private readonly listener: { drafted(draft: Draft): void; failed(fault: Fault): void; waiting(on: boolean): void },
  ) {}

  /** Asks soon, unless it is told so again before. */
  later(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.now(), IDLE);
  }

  async now(): Promise<void> {
    const number = ++this.asked;
    const wait = window.setTimeout(() => this.listener.waiting(number === this.asked), LONG);
    const answer = await this.ask();
    clearTimeout(wait);
    if (number === this.asked) this.listener.waiting(false);
    if (!answer || number !== this.asked || answer.outdated) return;
    const draft = answer.error ? null : readDraft(answer);
    if (draft) this.listener.drafted(draft);
    else this.listener.failed((answer.error as Fault | undefined) ?? UNREAD);
  }
}
