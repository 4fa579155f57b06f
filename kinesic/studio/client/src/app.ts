// Page of the studio: one document as text, timeline and stage.
import { blockTime } from "./anchors.ts";
import { listen } from "./controls.ts";
import { byId, say } from "./dom.ts";
import { Drafting } from "./drafting.ts";
import { type Added, alone, appendGesture, setAttribute, setManner } from "./edits.ts";
import { Exports } from "./exports.ts";
import { Files } from "./files.ts";
import { GestureEditing } from "./gesture_editing.ts";
import { begin, change, type History, redo, undo } from "./history.ts";
import { Inspector } from "./inspector.ts";
import { Motion } from "./motion.ts";
import { addDropped, listenToPalette } from "./palette.ts";
import { fillMenus, showClock, showNotices } from "./panels.ts";

import { listenToPanes } from "./panes.ts";
import { Performing } from "./performing.ts";
import { Playback } from "./playback.ts";
import { RecordingPanel } from "./recording/recording_panel.ts";
import { Robot } from "./robot.ts";
import { StylesPanel } from "./styles/styles_panel.ts";
import { TextPane } from "./text.ts";
import { TextMode } from "./text_mode/text_mode.ts";
import type { Timeline } from "./timeline.ts";
import { Tour } from "./tour/tour.ts";
import type { TrackEditing } from "./tracks/editing.ts";
import { Figures } from "./tracks/figures.ts";
import { openTimeline } from "./tracks/panel.ts";
import { pauseBefore } from "./tracks/pauses.ts";
import type { About, Draft, GestureDraft } from "./types.ts";
import { StageView } from "./view.ts";
import type { Answer } from "./wire.ts";
import { BLOCK } from "./xml.ts";

const GESTURE_ID = "g"; // id of the behaviour that performs a gesture under edit

class App {
  private readonly view: StageView;
  private readonly robot: Robot;
  private readonly text: TextPane;
  private readonly timeline: Timeline;
  private readonly tracks: TrackEditing;
  private readonly figures = new Figures(() => {
    this.editing.redrawList();
    this.showChosen();
  });
  private readonly performing = new Performing(
    (time) => this.playback.player.follow(time),
    (text) => say(byId("performing"), text),
  );
  private readonly playback: Playback;
  private readonly drafting: Drafting;
  private readonly inspector: Inspector;
  private readonly editing: GestureEditing;
  private readonly files: Files;
  private readonly textMode: TextMode;
  private readonly styles: StylesPanel;
  private readonly recording: RecordingPanel;
  private history: History<string> = begin("");
  private draft: Draft | null = null;
  private planned = 0; // number of shown drafts
  private asked = ""; // text of the last request for a plan
  private plannedText = ""; // text of the shown draft
  private performances = 0; // number of performances of single gestures
  private isPreparing = false; // whether gestures are chosen before a performance
  private performRequests = 0; // number of requests to perform, and of stops, which withdraw them

  constructor(private readonly about: About) {
    this.text = new TextPane((text) => this.edit(text, true));
    const timeline = openTimeline(
      {
        text: () => this.document,
        edit: (text) => this.edit(text),
        draft: () => this.draft,
        locked: () => this.isGesture,
        time: () => this.playback.player.time,
        chosen: () => this.showChosen(),
        say: (text) => say(byId("track-status"), text),
        seek: (time) => this.playback.player.seek(time),
        add: (value) => this.add((text, time) => addDropped(text, value, blockTime(time))),
      },
      this.figures,
    );
    this.tracks = timeline.tracks;
    this.timeline = timeline.timeline;
    this.robot = new Robot(about.robot, {
      opened: () => void this.connected(),
      changed: () => {
        if (this.robot?.stopped) this.withdraw();
        this.enable();
      },
      moved: () => {
        if (this.robot.report) {
          this.performing.reported(this.robot.report.time);
          this.recording.add(this.robot.report);
        }
        this.view.follow();
      },
      heard: (feedback) => this.performing.hear(feedback),
    });
    const exports = new Exports(this.robot.wire, (text) => this.robot.live.say(text));
    exports.listen(() => this.document);
    this.playback = new Playback(
      exports,
      () => this.document,
      (time) => this.showAt(time),
    );
    this.drafting = new Drafting(() => this.ask(), {
      waiting: (on) => say(byId("planning"), on ? "planning …" : ""),
      drafted: (draft) => this.showDraft(draft),
      failed: (fault) => {
        this.text.mark(fault);
        showNotices([{ type: "", id: `line ${fault.line}, column ${fault.column}`, text: fault.text }]);
      },
    });
    this.view = new StageView(
      about,
      this.robot,
      () => this.playback.player.time,
      (drag) => this.isGesture && drag.part === "hand" && this.editing.drop(drag),
    );
    this.inspector = new Inspector({
      attribute: (name, value) => this.chosen && this.edit(setAttribute(this.document, this.chosen, name, value)),
      manner: (name, value) => {
        this.styles.preview.expect();
        this.setManner(name, value);
      },
      style: (name) => this.chosen && this.edit(this.styles.choose(this.document, this.chosen, name)),
    });
    this.editing = new GestureEditing(about, this.robot.wire, {
      text: () => this.document,
      edit: (text) => this.edit(text),
      open: (name, text) => this.files.open(name, text),
      insert: (id) => this.insert(id),
      seek: (time) => this.playback.player.seek(time),
      say: (text) => this.robot.live.say(text),
      hand: (side) => this.view.stage.handPosition(side),
      picture: (gesture) => this.figures.draw(gesture),
    });
    this.files = new Files(about, this.robot.wire, {
      text: () => this.document,
      typed: () => this.textMode?.typed ?? "",
      retype: (typed) => this.textMode.retype(typed),
      show: (text) => this.show(text),
      edit: (text) => this.edit(text),
      saved: () => this.isGesture && this.editing.saved(),
      say: (text) => this.robot.live.say(text),
    });
    this.textMode = new TextMode(about, this.robot.wire, {
      text: () => this.document,
      edit: (text) => this.edit(text),
      open: (name, text) => this.files.open(name, text),
      changed: () => this.files.saving.isChanged,
      typed: () => this.files.saving.changed(),
      select: (id, time) => {
        this.playback.player.seek(time);
        if (id !== null && id !== this.chosen) this.tracks.choose(id, false);
      },
    });
    this.styles = new StylesPanel(this.robot.wire, this.view, this.playback.player, {
      numbers: () => this.inspector.manners.numbers,
      loaded: () => this.inspect(),
    });
    this.recording = new RecordingPanel(about.robot, {
      places: () => this.robot.places,
      show: (report) => {
        this.robot.look(report);
        this.view.setMode("robot");
      },
      say: (text) => this.robot.live.say(text),
    });
    this.listen();
    new Tour(() => this.textMode.tabs.choose("words"));
    listenToPalette(
      (edit) => this.add(edit),
      (duration) => this.pause(duration),
    );
    listenToPanes();
    fillMenus(this.about);
    this.files.begin();
  }

  // ---- the document -------------------------------------------------------------------------------------------

  private get document(): string {
    return this.history.present;
  }

  /** The only selected behaviour, or the gesture under edit. */
  private get chosen(): string | null {
    return this.isGesture ? GESTURE_ID : this.tracks.selection.single;
  }

  private get isGesture(): boolean {
    return this.files.saving.name.endsWith(".toml");
  }

  /** Show another document from its beginning. */
  private show(text: string): void {
    this.history = begin(text);
    this.tracks.selection.set([]);
    this.editing.begin(this.isGesture);
    this.textMode.begin(this.isGesture);
    this.text.show(text);
    this.view.setMode("plan");
    this.playback.player.seek(0);
    void this.drafting.now();
  }

  private edit(text: string, typed = false): void {
    this.step(change(this.history, text), typed);
  }

  private step(history: History<string>, typed = false): void {
    if (history === this.history) return;
    this.history = history;
    if (!typed) this.text.show(history.present);
    this.text.mark(null);
    this.drafting.later();
    this.files.saving.changed();
    this.enable();
  }

  private ask(): Promise<Answer | null> {
    this.enable();
    this.asked = this.document;
    if (!this.isGesture) return this.robot.wire.ask("plan", { bml: this.document });
    const set = [...this.editing.manner].map(([name, value]) => `${name}=${value}`);
    return this.robot.wire.ask("gesture", { toml: this.document, set });
  }

  private showDraft(draft: Draft): void {
    this.text.mark(null);
    this.draft = draft;
    this.view.motion = new Motion(draft, this.about.robot.hinges.length);
    this.playback.player.duration = draft.duration;
    this.planned += 1;
    this.plannedText = this.asked;
    this.tracks.drafted(draft);
    this.timeline.show(draft, this.tracks.selection.all);
    showNotices(draft.notices);
    this.textMode.show(draft);
    this.styles.preview.drafted(draft, this.isGesture ? GESTURE_ID : this.chosen);
    this.playback.player.seek(Math.min(this.playback.player.time, draft.duration));
    if ("keys" in draft) this.editing.show(draft as GestureDraft);
    this.inspect();
  }

  private showChosen(): void {
    if (this.draft) this.timeline.show(this.draft, this.tracks.selection.all);
    if (this.tracks.selection.single) this.text.find(this.tracks.selection.single);
    this.timeline.at(this.playback.player.time);
    this.inspect();
  }

  private insert(lexeme: string): void {
    this.add((text, time) => appendGesture(text, lexeme, blockTime(time)));
  }

  /** Add a behaviour at the time of the slider, and select it if it has an id. */
  private add(edit: (text: string, time: number) => Added | null): void {
    const time = Math.max(0, this.playback.player.time - (this.draft?.zero ?? 0));
    if (this.isGesture) this.robot.live.say("open a document first; this is a gesture");
    const added = this.isGesture ? null : edit(this.document, time);
    if (added) this.tracks.expect([added.id]);
    if (added) this.edit(added.text);
  }

  /** Put a pause [s] before the selected word, or the one at the slider; false outside of speeches. */
  private pause(duration: number): boolean {
    const isPlanned = !this.isGesture && this.plannedText === this.document;
    const word = isPlanned && this.draft ? this.textMode.wordAt(this.playback.player.time) : undefined;
    const paused = word ? pauseBefore(this.document, word, duration) : null;
    if (paused !== null) this.edit(paused);
    else this.robot.live.say("the pause is a wait: it delays only what refers to its end");
    return paused !== null;
  }

  private setManner(name: string, value: number | null): void {
    if (!this.isGesture) {
      if (this.chosen) this.edit(setManner(this.document, this.chosen, name, value));
      return;
    }
    if (value === null) this.editing.manner.delete(name);
    else this.editing.manner.set(name, value);
    void this.drafting.now();
  }

  private showAt(time: number): void {
    showClock(time, this.playback.player.duration, this.playback.player.playing);
    this.timeline.at(time);
    this.view.move();
    this.styles.preview.at(time);
  }

  private inspect(): void {
    const whole = this.chosen === BLOCK && this.draft ? { id: BLOCK, type: "block" } : null;
    const about = this.draft?.behaviours.find((each) => each.id === this.chosen) ?? whole;
    const read = (name: string) =>
      this.isGesture ? this.editing.manner.get(name)?.toString() : this.text.attribute(about?.id ?? "", name);
    const inherited = this.styles.inherited(this.document, about?.id ?? "");
    this.inspector.show(about ? { id: about.id, type: about.type, read, inherited, alone: this.isGesture } : null);
  }

  // ---- the server ---------------------------------------------------------------------------------------------

  private async connected(): Promise<void> {
    void this.styles.load();
    if (!(await this.files.connected())) void this.drafting.now();
  }

  /** BML to perform: the document, or a document for the edited gesture with the tried manner. */
  private get performed(): string {
    if (!this.isGesture || !this.draft) return this.document;
    return alone((this.draft as GestureDraft).gesture, this.editing.manner, ++this.performances);
  }

  /** Choose the gestures of typed words, and perform the document unless a stop withdraws the request. */
  private async perform(): Promise<void> {
    this.playback.player.play(false);
    const request = ++this.performRequests;
    if (this.textMode.typed && this.robot.ready) {
      this.isPreparing = true;
      const isWhole = await this.textMode.finish();
      this.isPreparing = false;
      if (request !== this.performRequests) return;
      if (!isWhole) {
        this.robot.live.say("not performed: the new words have no gestures yet");
        return;
      }
    }
    if (this.isGesture && !this.files.saving.isStored)
      this.robot.live.say("save the gesture first, so that the robot can use it");
    else if (this.robot.ready) {
      const bml = this.performed;
      this.performing.begin(bml);
      if (this.robot.wire.perform(bml)) this.view.setMode("robot");
    }
  }

  /** End the performance, or its preparation. */
  private withdraw(): void {
    this.performRequests += 1;
    this.performing.end();
  }

  private get rests(): boolean {
    return this.robot.rests && !this.performing.waits && !this.isPreparing && !this.playback.player.playing;
  }

  private stop(): void {
    this.performRequests += 1; // performing ends when the server has stopped
    this.robot.stop();
  }

  private async save(asksForName: boolean): Promise<void> {
    this.robot.askState(); // Escape stops in the dialog unless the robot rests
    if (this.textMode.typed && !(await this.textMode.finishToSave())) {
      this.robot.live.say("not saved: the new words have no gestures yet");
      return;
    }
    await this.files.saving.save(asksForName);
  }

  // ---- the page -----------------------------------------------------------------------------------------------

  private enable(): void {
    byId<HTMLButtonElement>("undo").disabled = !this.history.past.length;
    byId<HTMLButtonElement>("redo").disabled = !this.history.future.length;
    byId<HTMLButtonElement>("perform").disabled = !this.robot?.ready;
    byId("perform").title = this.robot?.limp ? "Arm the servos first" : "Perform on the robot (Ctrl Enter)";
    for (const name of ["save", "save-as"]) byId<HTMLButtonElement>(name).disabled = this.robot?.wire.state !== "open";
  }

  private listen(): void {
    listen({
      play: () => void this.playback.toggle(Boolean(this.draft?.loudness)),
      perform: () => void this.perform(),
      stop: () => this.stop(),
      rests: () => this.rests,
      resume: () => this.robot.resume(),
      undo: () => this.step(undo(this.history)),
      redo: () => this.step(redo(this.history)),
      save: () => void this.save(false),
      saveAs: () => void this.save(true),
      remove: () => this.tracks.remove(),
      show: (mode) => this.view.setMode(mode),
      view: (view) => this.view.stage.view(view),
      chooseBlock: () => this.tracks.choose(BLOCK, false),
      sectors: (on) => this.view.showSectors(on),
      seek: (time) => this.playback.player.seek(time),
      style: (style) => this.robot.wire.tell("style", { style }),
      loop: (on) => {
        this.playback.player.loops = on;
      },
      voice: (on) => this.playback.speak(on),
      list: () => this.files.fillMenu(),
      open: (kind, name) => this.files.choose(kind, name),
      unlock: (token) => this.robot.unlock(token),
    });
  }

  /** State for tests and debugging. */
  state(): Record<string, unknown> {
    return {
      ...this.view.state(),
      connection: this.robot.wire.state,
      text: this.document,
      past: this.history.past.length,
      name: this.files.saving.name,
      unsaved: this.files.saving.unsaved,
      place: this.files.saving.place,
      planned: this.planned,
      plannedText: this.plannedText,
      time: this.playback.player.time,
      performs: this.performing.runs,
      selected: [...this.tracks.selection.all],
      heard: this.playback.voice.time,
      stopped: this.robot.stopped,
      draft: this.draft && { ...this.draft, angles: this.draft.angles.length },
      report: this.robot.report,
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
