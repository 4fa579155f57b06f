// Servo torque: switched on after a person has confirmed a dialog, switched off by a click.
import { byId } from "./dom.ts";
import type { ServoReport } from "./types.ts";
import type { Answer, Wire } from "./wire.ts";

const BUTTON_LABELS: Record<ServoReport["state"], string> = {
  limp: "Motors on …",
  arming: "Switching on",
  armed: "Motors off",
  releasing: "Switching off",
  ended: "Motors on …",
};

export class Arming {
  private readonly button = byId<HTMLButtonElement>("arm");
  private readonly dialog = byId<HTMLDialogElement>("arming");
  private code: string | null = null; // confirmation code of the server
  private state: ServoReport["state"] | null = null;
  private ending = 0; // timer that withdraws the question
  private isConfirmed = false; // whether torque was requested, and the servos have not reported another state yet

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

  /** Whether there are servos without torque. */
  get isTorqueOff(): boolean {
    return this.state !== null && this.state !== "armed" && this.state !== "arming";
  }

  /** Whether no servo has torque or is about to get it. */
  get rests(): boolean {
    return !this.isConfirmed && (this.state === null || this.state === "limp");
  }

  show(report: ServoReport | null): void {
    this.state = report?.state ?? null;
    if (this.state !== "limp") this.isConfirmed = false;
    this.button.hidden = this.state === null;
    if (this.state === null) return;
    this.button.textContent = BUTTON_LABELS[this.state];
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

  /** Confirm after a click by a person; clicks by scripts are ignored. */
  private async confirm(event: Event): Promise<void> {
    const { code } = this;
    if (!event.isTrusted || code === null) return;
    this.end();
    this.isConfirmed = true;
    const answer = await this.wire.ask("arm", { token: this.token(), code });
    if (answer?.told === "refused") this.isConfirmed = false;
    this.tell(answer);
  }

  private async disarm(): Promise<void> {
    this.tell(await this.wire.ask("disarm", {}));
  }

  private tell(answer: Answer | null): void {
    this.say(answer?.told === "refused" ? String(answer.why) : String(answer?.told ?? "no server"));
  }

  /** Withdraw the question. */
  end(): void {
    clearTimeout(this.ending);
    this.code = null;
    if (this.dialog.open) this.dialog.close();
  }
}
