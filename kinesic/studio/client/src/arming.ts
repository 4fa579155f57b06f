// Torque of the servos: given when a person has confirmed it in a dialog of this page, taken by a click.
import { byId } from "./dom.ts";
import type { ServoReport } from "./types.ts";
import type { Answer, Wire } from "./wire.ts";

const WORDS: Record<ServoReport["state"], string> = {
  limp: "Arm …",
  arming: "Arming",
  armed: "Disarm",
  releasing: "Disarming",
  ended: "Arm …",
};

export class Arming {
  private readonly button = byId<HTMLButtonElement>("arm");
  private readonly dialog = byId<HTMLDialogElement>("arming");
  private code: string | null = null; // that the server wants to hear again
  private state: ServoReport["state"] | null = null;
  private ending = 0; // the timer of the question that is asked

  constructor(
    private readonly wire: Wire,
    private readonly token: () => string | null,
    private readonly say: (text: string) => void,
  ) {
    this.button.addEventListener("click", () => void (this.state === "armed" ? this.disarm() : this.ask()));
    byId("arm-no").addEventListener("click", () => this.end());
    byId("arm-yes").addEventListener("click", (event) => void this.confirm(event));
    this.dialog.addEventListener("close", () => this.end());
  }

  /** Whether servos are there that do not follow. */
  get limp(): boolean {
    return this.state !== null && this.state !== "armed" && this.state !== "arming";
  }

  show(report: ServoReport | null): void {
    this.state = report?.state ?? null;
    this.button.hidden = this.state === null;
    if (this.state === null) return;
    this.button.textContent = WORDS[this.state];
    this.button.disabled = this.state === "arming" || this.state === "releasing";
  }

  private async ask(): Promise<void> {
    const answer = await this.wire.ask("arm", { token: this.token() });
    if (answer?.told !== "confirm") return this.tell(answer);
    this.code = String(answer.code);
    byId("arm-count").textContent = String(answer.servos);
    this.dialog.showModal();
    this.ending = setTimeout(() => this.end(), 1000 * Number(answer.lasts));
  }

  /** A person has pressed the button: nothing that a script does is taken for that. */
  private async confirm(event: Event): Promise<void> {
    const { code } = this;
    if (!event.isTrusted || code === null) return;
    this.end();
    this.tell(await this.wire.ask("arm", { token: this.token(), code }));
  }

  private async disarm(): Promise<void> {
    this.tell(await this.wire.ask("disarm", {}));
  }

  private tell(answer: Answer | null): void {
    this.say(answer?.told === "refused" ? String(answer.why) : String(answer?.told ?? "no server"));
  }

  /** Asks nobody any more. */
  end(): void {
    clearTimeout(this.ending);
    this.code = null;
    if (this.dialog.open) this.dialog.close();
  }
}
