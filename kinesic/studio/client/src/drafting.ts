// Requests the plan of a changed document, after a pause in typing; only the answer for the present document counts.
import { readDraft } from "./checks.ts";
import type { Draft, Fault } from "./types.ts";
import type { Answer } from "./wire.ts";

const INVALID_ANSWER: Fault = { line: 1, column: 1, text: "the server's answer is invalid; its version may differ" };
const TYPING_PAUSE = 150; // [ms] pause after the last change
const WAIT_DELAY = 400; // [ms] without an answer until a waiting message is shown

export class Drafting {
  private timer = 0;
  private asked = 0;
  private isWaiting = false; // whether an answer or the end of a pause is awaited

  constructor(
    private readonly ask: () => Promise<Answer | null>,
    private readonly listener: { drafted(draft: Draft): void; failed(fault: Fault): void; waiting(on: boolean): void },
  ) {}

  /** Request a plan of a changed document after a pause; another call restarts the pause. */
  later(): void {
    this.asked += 1; // a plan of the former document must not replace the shown one
    this.isWaiting = true;
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.now(), TYPING_PAUSE);
  }

  /** Request a plan at once, or after a pause while the plan of an earlier change is awaited. */
  soon(): void {
    if (this.isWaiting) this.later();
    else void this.now();
  }

  async now(): Promise<void> {
    clearTimeout(this.timer);
    const number = ++this.asked;
    this.isWaiting = true;
    const wait = window.setTimeout(() => this.listener.waiting(number === this.asked), WAIT_DELAY);
    const answer = await this.ask();
    clearTimeout(wait);
    if (number === this.asked) {
      this.isWaiting = false;
      this.listener.waiting(false);
    }
    if (!answer || number !== this.asked || answer.outdated) return;
    const draft = answer.error ? null : readDraft(answer);
    if (draft) this.listener.drafted(draft);
    else this.listener.failed((answer.error as Fault | undefined) ?? INVALID_ANSWER);
  }
}
