// Parts of the studio's page and their connections: a document as text, timeline and stage, and the robot.
import { listActions } from "./actions.ts";
import { listen } from "./controls.ts";
import { Display } from "./display.ts";
import { byId, say } from "./dom.ts";
import { EditedDocument } from "./edited_document.ts";
import { Exports } from "./exports.ts";
import { Files } from "./files.ts";
import { GestureEditing } from "./gesture_editing.ts";
import { Insertion } from "./insertion.ts";
import { Inspection } from "./inspection.ts";
import { readState } from "./page_state.ts";
import { listenToPalette } from "./palette.ts";
import { fillMenus } from "./panels.ts";
import { listenToPanes } from "./panes.ts";
import { Performances } from "./performances.ts";
import { Performing } from "./performing.ts";
import { PlannedDocument } from "./planned_document.ts";
import { Playback } from "./playback.ts";
import type { Player } from "./player.ts";
import { GestureRecorder } from "./recording/gesture_recorder.ts";
import { RecordingPanel } from "./recording/recording_panel.ts";
import { Robot } from "./robot.ts";
import { StylesPanel } from "./styles/styles_panel.ts";
import { TextPane } from "./text.ts";
import { markEdited } from "./text_mode/picked_gestures.ts";
import { isWritten } from "./text_mode/replacing.ts";
import { TextMode } from "./text_mode/text_mode.ts";
import type { Timeline } from "./timeline.ts";
import { Tour } from "./tour/tour.ts";
import type { TrackEditing } from "./tracks/editing.ts";
import { Figures } from "./tracks/figures.ts";
import { openTimeline } from "./tracks/panel.ts";
import type { About } from "./types.ts";
import { StageView } from "./view.ts";
import { WizardPanel } from "./wizard/wizard_panel.ts";

const GESTURE_ID = "g"; // id of the behaviour that performs a gesture under edit

export class Studio {
  readonly textPane = new TextPane((text) => this.document.edit(text, true));
  readonly document = new EditedDocument((isTyped) => this.display.change(isTyped));
  readonly display = new Display(this);
  private readonly figures = new Figures(() => {
    this.gestures.redrawList();
    this.display.selection();
  });
  readonly performing = new Performing(
    (time) => this.player.follow(time),
    (text) => say(byId("performing"), text),
  );
  readonly plan: PlannedDocument;
  readonly view: StageView;
  readonly robot: Robot;
  readonly timeline: Timeline;
  readonly tracks: TrackEditing;
  readonly playback: Playback;
  readonly performances: Performances;
  readonly insertion: Insertion;
  readonly inspection: Inspection;
  readonly gestures: GestureEditing;
  readonly files: Files;
  readonly textMode: TextMode;
  readonly styles: StylesPanel;
  readonly recording: RecordingPanel;
  readonly recorder: GestureRecorder;
  readonly wizard: WizardPanel;

  constructor(readonly about: About) {
    const text = () => this.document.text;
    const rewrite = (changed: string) => this.document.edit(changed);
    const edit = (changed: string) => rewrite(isWritten(changed) ? markEdited(text(), changed) : changed);
    const isGesture = () => this.isGesture;
    const log = (line: string) => this.robot.live.say(line);
    const seek = (time: number) => this.player.seek(time);
    const open = (name: string, opened: string) => this.files.open(name, opened);
    this.plan = new PlannedDocument({
      text,
      request: () => {
        this.display.buttons();
        return this.isGesture ? this.gestures.ask() : this.robot.wire.ask("plan", { bml: this.document.text });
      },
      planned: (draft) => this.display.plan(draft),
      failed: (fault) => this.display.fault(fault),
    });
    ({ tracks: this.tracks, timeline: this.timeline } = openTimeline(
      {
        ...{ text, edit, seek, locked: isGesture },
        draft: () => this.plan.draft,
        time: () => this.player.time,
        chosen: () => {
          this.display.selection();
          this.textMode?.follow(this.tracks.selection.single);
        },
        say: (line) => say(byId("track-status"), line),
        add: (value) => this.insertion.paletteEntry(value),
        poses: {
          choose: (pose) => this.gestures.choose(pose),
          reorder: (from, to) => this.gestures.reorder(from, to),
        },
      },
      this.figures,
    ));
    this.robot = new Robot(about.robot, {
      opened: () => void this.connected(),
      changed: () => {
        if (this.robot.stopped) this.performances.withdraw();
        this.display.buttons();
      },
      moved: () => {
        if (this.robot.report) {
          this.performing.reported(this.robot.report.time);
          this.recording.add(this.robot.report);
          this.recorder.addReport(this.robot.report);
        }
        this.view.follow();
      },
      heard: (feedback) => this.performing.hear(feedback),
      told: (answer) => this.wizard?.hear(answer),
    });
    const exports = new Exports(this.robot.wire, log);
    exports.listen(text);
    this.playback = new Playback(exports, text, (time) => this.display.time(time));
    this.view = new StageView(about, this.robot, () => this.player.time, {
      dropped: (drag) =>
        this.isGesture && drag.part === "hand" && !this.recorder.isRecording && this.gestures.drop(drag),
      reached: (angles) => this.recorder.addDragged(angles),
    });
    this.performances = new Performances(this.robot, this.performing, {
      bml: () => (this.isGesture ? this.gestures.performed() : this.document.text),
      hasTypedWords: () => this.textMode.typed !== "",
      chooseGestures: () => this.textMode.finish(),
      isUnsavedGesture: () => this.isGesture && !this.files.saving.isStored,
      isPlaying: () => this.player.playing,
      pause: () => this.player.play(false),
      sent: () => {
        this.styles.preview.cancel();
        this.view.setMode("robot");
      },
    });
    this.insertion = new Insertion(this.plan, {
      ...{ text, edit, isGesture, say: log },
      time: () => this.player.time,
      wordAt: (time) => this.textMode.wordAt(time),
      expect: (id) => this.tracks.expect([id]),
    });
    this.inspection = new Inspection(() => this.styles, {
      ...{ text, edit, isGesture },
      draft: () => this.plan.draft,
      selected: () => (this.isGesture ? [GESTURE_ID] : [...this.tracks.selection.all]),
      tried: () => this.gestures.expressivity,
      tryAgain: () => this.plan.now(),
    });
    this.gestures = new GestureEditing(about, this.robot.wire, {
      ...{ text, edit, open, seek, say: log },
      insert: (id) => {
        if (!this.textMode.place(id)) this.insertion.gesture(id);
      },
      hand: (side) => this.view.stage.handPosition(side),
      picture: (gesture) => this.figures.draw(gesture),
    });
    this.files = new Files(about, this.robot.wire, {
      ...{ text, edit, say: log },
      typed: () => this.textMode?.typed ?? "",
      retype: (typed) => this.textMode.retype(typed),
      show: (opened) => this.display.document(opened),
      saved: () => this.isGesture && this.gestures.saved(),
    });
    this.textMode = new TextMode(about, this.robot.wire, {
      ...{ text, edit, rewrite, open },
      changed: () => this.files.saving.isChanged,
      typed: () => this.files.saving.changed(),
      picture: (gesture) => this.figures.draw(gesture),
      select: (id, time) => {
        seek(time);
        if (id !== null && id !== this.tracks.selection.single) this.tracks.choose(id, false);
      },
    });
    this.styles = new StylesPanel(this.robot.wire, this.view, this.player, {
      numbers: () => this.inspection.numbers,
      loaded: () => this.inspection.show(),
    });
    this.recording = new RecordingPanel(about.robot, {
      places: () => this.robot.places,
      show: (report) => {
        this.robot.look(report);
        this.view.setMode("robot");
      },
      say: log,
    });
    this.recorder = new GestureRecorder(about.robot, {
      hand: (side, angles) => this.view.stage.handPosition(side, angles),
      open,
      isMovedByHand: () => this.robot.isTorqueOff,
      show: (mode) => this.view.setMode(mode),
    });
    this.wizard = new WizardPanel(this.robot.wire, log, () => this.view.setMode("robot"));
    listen(listActions(this));
    new Tour(() => this.textMode.tabs.choose("words"));
    listenToPalette(
      (added) => this.insertion.add(added),
      (duration) => this.insertion.pause(duration),
    );
    listenToPanes();
    fillMenus(this.about);
    this.files.begin();
  }

  get player(): Player {
    return this.playback.player;
  }

  /** Whether the document is a gesture under edit. */
  get isGesture(): boolean {
    return this.files.saving.name.endsWith(".toml");
  }

  /** State for tests and debugging. */
  state(): Record<string, unknown> {
    return readState(this);
  }

  private async connected(): Promise<void> {
    void this.styles.load();
    if (!(await this.files.connected())) this.plan.now();
  }
}
