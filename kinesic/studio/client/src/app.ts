// The page: one document, seen as text, as a timeline and on the stage.
import { byId, make } from "./dom.ts";
import { mark, remove, setAttribute, setManner, shift, tie } from "./edits.ts";
import { begin, change, type History, redo, undo } from "./history.ts";
import { Live } from "./live.ts";
import { Manners } from "./manners.ts";
import { Motion } from "./motion.ts";
import { Player } from "./player.ts";
import { Reaching } from "./reaching.ts";
import { Stage, VIEWS } from "./stage.ts";
import { TextPane } from "./text.ts";
import { anchorOf, type Moved, Timeline } from "./timeline.ts";
import type { About, BodyReport, Draft, Fault, Reached } from "./types.ts";
import { type Answer, Wire } from "./wire.ts";

const IDLE = 150; // [ms] after the last change, when a document is planned

class App {
  private readonly stage: Stage;
  private readonly wire: Wire;
  private readonly text: TextPane;
  private readonly timeline: Timeline;
  private readonly player: Player;
  private readonly live: Live;
  private readonly reaching: Reaching;
  private readonly manners: Manners;
  private history: History<string> = begin("");
  private draft: Draft | null = null;
  private motion: Motion | null = null;
  private chosen: string | null = null;
  private timer = 0;
  private asked = 0;
  private planned = 0; // drafts that were shown
  private mode: "plan" | "robot" = "plan";
  private report: BodyReport | null = null;
  private name = "untitled.bml";
  private stopped = false;

  constructor(private readonly about: About) {
    this.stage = new Stage(byId<HTMLCanvasElement>("canvas"), about.robot, {
      drag: (drag) => this.reaching.drag(drag),
      drop: () => this.reaching.drop(),
    });
    this.text = new TextPane((text) => this.edit(text, { typed: true }));
    this.player = new Player((time) => this.showAt(time));
    this.timeline = new Timeline(byId("rows"), {
      moved: (moved) => this.move(moved),
      seek: (time) => this.player.seek(time),
      choose: (id) => this.choose(id),
    });
    this.live = new Live(about.robot);
    this.manners = new Manners((name, value) => {
      if (this.chosen) this.edit(setManner(this.history.present, this.chosen, name, value));
    });
    this.wire = new Wire(
      {
        state: () => this.connected(),
        told: (answer) => this.told(answer),
        feedback: (xml) => this.live.feedback(xml),
      },
      sessionStorage.getItem("token"),
    );
    this.reaching = new Reaching(
      about.robot,
      this.wire,
      (found) => this.reached(found),
      () => this.posture(),
    );
    this.listen();
    this.fillExamples();
    this.open(about.examples[0]?.name ?? "untitled", about.examples[0]?.text ?? "");
  }

  // ---- the document -------------------------------------------------------------------------------------------

  private open(name: string, text: string): void {
    this.name = name.includes(".") ? name : `${name}.bml`;
    byId("file").textContent = this.name;
    this.chosen = null;
    this.history = begin(text);
    this.text.show(text);
    this.player.seek(0);
    this.ask();
  }

  private edit(text: string, { typed = false } = {}): void {
    this.step(change(this.history, text), typed);
  }

  private step(history: History<string>, typed = false): void {
    if (history === this.history) return;
    this.history = history;
    if (!typed) this.text.show(history.present);
    this.text.mark(null);
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.ask(), IDLE);
    this.enable();
  }

  private async ask(): Promise<void> {
    this.enable();
    const asked = ++this.asked;
    const answer = await this.wire.ask("plan", { bml: this.history.present });
    if (!answer || asked !== this.asked || answer.outdated) return;
    const fault = answer.error as Fault | undefined;
    this.text.mark(fault ?? null);
    if (fault) {
      this.notices([{ type: "", id: `line ${fault.line}, column ${fault.column}`, text: fault.text }]);
      return;
    }
    this.draft = answer as unknown as Draft;
    this.motion = new Motion(this.draft, this.about.robot.hinges.length);
    this.player.duration = this.draft.duration;
    this.planned += 1;
    this.timeline.show(this.draft, this.chosen);
    this.notices(this.draft.notices);
    this.player.seek(Math.min(this.player.time, this.draft.duration));
    this.inspect();
  }

  private move({ behaviour, point, onto }: Moved): void {
    const text = this.history.present;
    if ("by" in onto) {
      const zero = this.draft?.zero ?? 0;
      this.edit(shift(text, behaviour, point, onto.by, onto.asked - zero));
      return;
    }
    const marked = mark(text, onto.speech, onto.mark, onto.index);
    this.edit(tie(marked.text, behaviour, point, anchorOf({ ...onto, mark: marked.mark })));
  }

  private choose(id: string): void {
    this.chosen = this.chosen === id ? null : id;
    if (this.draft) this.timeline.show(this.draft, this.chosen);
    if (this.chosen) this.text.find(this.chosen);
    this.player.seek(this.player.time);
    this.inspect();
  }

  // ---- the stage ----------------------------------------------------------------------------------------------

  private showAt(time: number): void {
    byId<HTMLInputElement>("time").value = String(time);
    byId<HTMLInputElement>("time").max = String(this.player.duration);
    byId("clock").textContent = `${time.toFixed(2)} / ${this.player.duration.toFixed(2)} s`;
    byId("play").setAttribute("aria-label", this.player.playing ? "Pause" : "Play");
    byId("play").classList.toggle("playing", this.player.playing);
    this.timeline.at(time);
    this.reaching.forget();
    this.redraw();
  }

  private redraw(): void {
    const dragged = this.reaching.shown;
    const planned = this.motion?.at(this.player.time) ?? this.about.robot.rest;
    const lit = this.reaching.lit;
    if (dragged) this.stage.show({ angles: dragged, ghost: undefined, lit });
    else if (this.mode === "robot" && this.report)
      this.stage.show({ angles: this.report.angles, ghost: this.report.planned, lit });
    else this.stage.show({ angles: planned, ghost: undefined, lit });
  }

  private reached(found: Reached | null): void {
    byId("stops").textContent = this.reaching.words(found);
    byId("stops").classList.toggle("warning", found !== null && !found.reached);
    this.redraw();
  }

  private posture(): number[] {
    if (this.mode === "robot" && this.report) return this.report.angles;
    return this.motion?.at(this.player.time) ?? this.about.robot.rest;
  }

  private become(mode: "plan" | "robot"): void {
    this.mode = mode;
    this.reaching.forget();
    for (const name of ["plan", "robot"]) byId(`mode-${name}`).setAttribute("aria-pressed", String(name === mode));
    this.redraw();
  }

  // ---- the server ---------------------------------------------------------------------------------------------

  private connected(): void {
    const { state } = this.wire;
    document.body.dataset.state = state;
    const words = { connecting: "connecting", open: "connected", locked: "token needed", closed: "no server" };
    byId("state").textContent = words[state];
    byId<HTMLDialogElement>("lock")[state === "locked" ? "show" : "close"]();
    byId<HTMLButtonElement>("stop").disabled = state === "closed" || state === "connecting";
    if (state === "open") {
      this.wire.tell("watch", { rate: 20 });
      this.wire.tell("status");
      void this.ask();
      if (this.about.document) void this.openSaved(this.about.document);
      this.about.document = null;
    }
    this.enable();
  }

  private told(answer: Answer): void {
    if (answer.told === "body") {
      this.report = answer as unknown as BodyReport;
      this.live.show(this.report);
      if (this.mode === "robot") this.redraw();
    } else if (answer.told === "stopped" || answer.told === "failed") this.halted(String(answer.why ?? ""));
    else if (answer.told === "status") this.halt(answer.state === "stopped");
    else if (answer.told === "refused") this.live.say(String(answer.why));
  }

  private halted(why: string): void {
    this.halt(true);
    this.live.say(why || "stopped: every hinge holds");
  }

  private halt(stopped: boolean): void {
    this.stopped = stopped;
    document.body.classList.toggle("stopped", stopped);
    byId("resume").hidden = !stopped;
    this.enable();
  }

  private stop(): void {
    if (!this.wire.stop()) this.live.say("no server: use the switch that cuts the power");
  }

  private perform(): void {
    this.player.play(false);
    if (!this.wire.perform(this.history.present)) return;
    this.become("robot");
  }

  private async openSaved(name: string): Promise<void> {
    const answer = await this.wire.ask("open", { name });
    if (answer?.told === "document") this.open(name, String(answer.text));
    else if (answer) this.live.say(String(answer.why));
  }

  private async save(): Promise<void> {
    const name = prompt("Save as", this.name);
    if (name === null) return;
    const answer = await this.wire.ask("save", { name, text: this.history.present });
    this.live.say(answer?.told === "saved" ? `saved: ${name}` : String(answer?.why ?? "no server"));
    if (answer?.told !== "saved") return;
    this.name = name;
    byId("file").textContent = name;
    void this.listSaved();
  }

  private async listSaved(): Promise<void> {
    const answer = await this.wire.ask("open", {});
    const names = (answer?.names as string[] | undefined) ?? [];
    const group = byId("saved");
    group.replaceChildren(
      ...names.filter((name) => name.endsWith(".bml")).map((name) => make("option", { value: `file:${name}` }, name)),
    );
  }

  // ---- the page -----------------------------------------------------------------------------------------------

  private enable(): void {
    const there = this.wire?.state === "open";
    byId<HTMLButtonElement>("undo").disabled = !this.history.past.length;
    byId<HTMLButtonElement>("redo").disabled = !this.history.future.length;
    byId<HTMLButtonElement>("perform").disabled = !there || this.stopped;
    byId<HTMLButtonElement>("save").disabled = !there;
  }

  private notices(notices: Draft["notices"]): void {
    const lines = notices.map(({ id, text }) => make("li", {}, make("b", {}, id), ` ${text}`));
    byId("notices").replaceChildren(...(lines.length ? lines : [make("li", { class: "none" }, "all as asked")]));
  }

  private fillExamples(): void {
    const group = byId("built-in");
    for (const { name } of this.about.examples)
      group.append(make("option", { value: `example:${name}` }, name.replaceAll("_", " ")));
    for (const { id, says } of this.about.gestures) byId("gestures").append(make("option", { value: id }, says));
  }

  /** Shows what can be set of the chosen behaviour. */
  private inspect(): void {
    const about = this.draft?.behaviours.find((each) => each.id === this.chosen);
    byId("inspector").hidden = !about;
    if (!about) return;
    byId("chosen").textContent = `${about.type} ${about.id}`;
    const isGesture = about.type === "gesture";
    byId("lexeme-line").hidden = byId("hand-line").hidden = !isGesture;
    for (const name of ["lexeme", "mode"] as const)
      byId<HTMLInputElement>(name).value = this.text.attribute(about.id, name) ?? "";
    byId("manners").hidden = about.type === "speech";
    this.manners.show((name) => this.text.attribute(about.id, name));
  }

  private listen(): void {
    const click = (id: string, act: () => void) => byId(id).addEventListener("click", act);
    click("play", () => this.player.play(!this.player.playing));
    click("perform", () => this.perform());
    click("stop", () => this.stop());
    click("resume", () => {
      this.wire.tell("resume");
      this.halt(false);
    });
    click("undo", () => this.step(undo(this.history)));
    click("redo", () => this.step(redo(this.history)));
    click("save", () => void this.save());
    click("mode-plan", () => this.become("plan"));
    click("mode-robot", () => this.become("robot"));
    click("remove", () => this.chosen && this.edit(remove(this.history.present, this.chosen)));
    for (const view of VIEWS) click(`view-${view}`, () => this.stage.view(view));
    byId("time").addEventListener("input", () => this.player.seek(Number(byId<HTMLInputElement>("time").value)));
    byId("loop").addEventListener("change", () => {
      this.player.loops = byId<HTMLInputElement>("loop").checked;
    });
    const menu = byId<HTMLSelectElement>("examples");
    menu.addEventListener("pointerdown", () => void this.listSaved());
    menu.addEventListener("change", () => {
      const [kind, name] = [menu.value.split(":")[0], menu.value.slice(menu.value.indexOf(":") + 1)];
      menu.value = "";
      const example = this.about.examples.find((each) => each.name === name);
      if (kind === "example" && example) this.open(name, example.text);
      else void this.openSaved(name);
    });
    for (const name of ["lexeme", "mode"] as const)
      byId(name).addEventListener("change", () => {
        const value = byId<HTMLInputElement>(name).value.trim();
        if (this.chosen) this.edit(setAttribute(this.history.present, this.chosen, name, value || null));
      });
    byId("lock").addEventListener("submit", (event) => {
      event.preventDefault();
      const token = byId<HTMLInputElement>("token").value;
      sessionStorage.setItem("token", token);
      this.wire.unlock(token);
    });
    document.addEventListener("keydown", (event) => this.key(event));
  }

  private key(event: KeyboardEvent): void {
    const element = event.target as HTMLElement;
    const writes = element.matches("textarea, input:not([type=range]):not([type=checkbox]), select");
    if (
      event.key === "Escape" ||
      (event.key === " " && !writes && !element.matches("button, summary, [type=checkbox]"))
    ) {
      event.preventDefault();
      this.stop();
    }
    if (!(event.ctrlKey || event.metaKey)) return;
    const act = {
      z: () => this.step(event.shiftKey ? redo(this.history) : undo(this.history)),
      Z: () => this.step(redo(this.history)),
      y: () => this.step(redo(this.history)),
      s: () => void this.save(),
      Enter: () => this.perform(),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** What tests and curious people may read. */
  state(): Record<string, unknown> {
    return {
      connection: this.wire.state,
      text: this.history.present,
      past: this.history.past.length,
      planned: this.planned,
      drawn: this.stage.drawn,
      flat: this.stage.flat,
      time: this.player.time,
      playing: this.player.playing,
      mode: this.mode,
      stopped: this.stopped,
      look: this.stage.look,
      left: this.stage.handAt("left"),
      right: this.stage.handAt("right"),
      reach: this.reaching.found,
      latencies: this.reaching.latencies,
      draft: this.draft && { ...this.draft, angles: this.draft.angles.length },
      report: this.report,
    };
  }
}

declare global {
  interface Window {
    kinesicStudio?: { state(): Record<string, unknown> };
  }
}

const response = await fetch("studio.json");
window.kinesicStudio = new App((await response.json()) as About);
