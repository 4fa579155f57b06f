// Panel of a wizard, who makes the robot converse by buttons: people, states, fillers and lines with hotkeys.
import { byId, make, say as write } from "../dom.ts";
import { openStorage } from "../remembered.ts";
import type { Answer, Wire } from "../wire.ts";
import { converse, FILLERS, linesOf, listen, lookAt, nod, PERSON, PLACES, say, think, yieldTurn } from "./deeds.ts";
import { type Deed, Session } from "./session.ts";

const REPORT_PERIOD = 400; // [ms] between two reports of a person who stays
const LINES_KEY = "kinesic.wizard.lines"; // key of the lines in the browser's storage
const MAX_HOTKEY = 9; // last digit that says a line, with Alt

export class WizardPanel {
  readonly session = new Session();
  private readonly lines = byId<HTMLTextAreaElement>("wizard-lines");
  private readonly pressed = new Set<string>(); // toggles that are on
  private nods = 0;
  private reporting: ReturnType<typeof setTimeout> | undefined;
  private replaying: ReturnType<typeof setTimeout>[] = [];

  constructor(
    private readonly wire: Wire,
    private readonly log: (text: string) => void,
    /** Called with each press, so that the stage shows the robot instead of the plan. */
    private readonly pressing: () => void = () => {},
  ) {
    const acts = byId("wizard-acts");
    this.addToggle(acts, "Converse", converse);
    this.addToggle(acts, "Listen", listen);
    this.addToggle(acts, "Think", think);
    this.addButton(acts, "Nod", () => [nod(++this.nods)]);
    this.addButton(acts, "Yield", () => [yieldTurn()]);
    for (const [name, at] of Object.entries(PLACES))
      this.addButton(byId("wizard-places"), `Look at ${name}`, () => [lookAt(at)]);
    this.addButton(byId("wizard-places"), "Nobody", () => [{ do: "people", values: { people: [] } }]);
    for (const filler of FILLERS) this.addButton(byId("wizard-fillers"), filler, () => [say(filler)]);
    this.lines.value = openStorage()?.getItem(LINES_KEY) ?? this.lines.value;
    this.lines.addEventListener("input", () => this.showLines());
    document.addEventListener("keydown", (event) => this.hotkey(event));
    byId("wizard-csv").addEventListener("click", () => this.save("wizard.csv", "text/csv", this.session.csv()));
    byId("wizard-eaf").addEventListener("click", () =>
      this.save("wizard.eaf", "application/xml", this.session.eaf(new Date())),
    );
    byId("wizard-replay").addEventListener("click", () => this.replay());
    byId("wizard-clear").addEventListener("click", () => this.clear());
    this.showLines();
    this.count();
  }

  /** Show and log a new state of the robot or the person whom it attends. */
  hear(answer: Answer): void {
    if (answer.told !== "conversing") return;
    if (answer.state === "off") this.release();
    const words = [String(answer.state), answer.who === undefined ? "nobody" : String(answer.who)];
    const shown = answer.who === PERSON ? `${answer.state}, a person` : words.join(", ");
    write(byId("wizard-state"), shown);
    this.session.add(performance.now(), "state", words.join(", "));
    this.count();
  }

  private addButton(place: HTMLElement, label: string, deeds: () => Deed[], hint = label): void {
    const button = make("button", { type: "button", title: hint }, label);
    button.addEventListener("click", () => this.press(label, deeds()));
    place.append(button);
  }

  private addToggle(place: HTMLElement, label: string, deed: (on: boolean) => Deed): void {
    const button = make("button", { type: "button", "aria-pressed": "false" }, label);
    button.addEventListener("click", () => {
      const on = !this.pressed.delete(label);
      if (on) this.pressed.add(label);
      button.setAttribute("aria-pressed", String(on));
      this.press(`${label} ${on ? "on" : "off"}`, [deed(on)]);
    });
    place.append(button);
  }

  /** Show all toggles as off, as a stop has ended the conversation. */
  private release(): void {
    this.pressed.clear();
    for (const button of byId("wizard-acts").querySelectorAll("[aria-pressed]"))
      button.setAttribute("aria-pressed", "false");
  }

  private press(label: string, deeds: readonly Deed[]): void {
    this.session.add(performance.now(), "press", label, deeds);
    this.pressing();
    this.send(deeds);
    this.count();
  }

  /** Send messages; a report of people is repeated until the next one. */
  private send(deeds: readonly Deed[]): void {
    for (const deed of deeds) {
      if (deed.do === "bml") this.wire.perform(String(deed.values.bml));
      else this.wire.tell(deed.do, deed.values);
      if (deed.do !== "people") continue;
      clearTimeout(this.reporting);
      if ((deed.values.people as unknown[]).length) this.reporting = setTimeout(() => this.send([deed]), REPORT_PERIOD);
    }
  }

  private showLines(): void {
    openStorage()?.setItem(LINES_KEY, this.lines.value);
    const place = byId("wizard-say");
    place.replaceChildren();
    for (const [k, line] of linesOf(this.lines.value).entries())
      this.addButton(place, line, () => [say(line)], k < MAX_HOTKEY ? `Alt+${k + 1}` : line);
  }

  /** Say the line of Alt and a digit while the panel is open. */
  private hotkey(event: KeyboardEvent): void {
    const digit = /^Digit([1-9])$/.exec(event.code)?.[1];
    const line = digit === undefined ? undefined : linesOf(this.lines.value)[Number(digit) - 1];
    if (!event.altKey || line === undefined || !byId<HTMLDetailsElement>("wizard").open) return;
    event.preventDefault();
    this.press(line, [say(line)]);
  }

  /** Send all presses of the session again at their times; a second press ends the replay. */
  private replay(): void {
    const wasReplaying = this.replaying.length > 0;
    for (const timer of this.replaying) clearTimeout(timer);
    this.replaying = [];
    const { presses } = this.session;
    const last = presses.at(-1);
    this.count();
    if (wasReplaying || !last) return;
    const from = presses[0]?.time ?? 0;
    for (const entry of presses)
      this.replaying.push(
        setTimeout(
          () => {
            this.send(entry.deeds);
            if (entry === last) this.replaying = [];
            this.count();
          },
          1000 * (entry.time - from),
        ),
      );
    this.count();
  }

  private clear(): void {
    this.session.clear();
    this.count();
  }

  private count(): void {
    const words = this.replaying.length ? "replaying" : `${this.session.presses.length} presses logged`;
    write(byId("wizard-status"), words);
    write(byId("wizard-replay"), this.replaying.length ? "End the replay" : "Replay");
  }

  private save(name: string, type: string, content: string): void {
    const address = URL.createObjectURL(new Blob([content], { type }));
    make("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
    this.log(`exported: ${name}, ${this.session.entries.length} entries`);
  }
}
