// Shows a changed document, plan, selection or time in all parts of the page.
import { enableButtons } from "./buttons.ts";
import { Motion } from "./motion.ts";
import { showClock, showFault, showNotices } from "./panels.ts";
import type { Studio } from "./studio.ts";
import type { Draft, Fault, GestureDraft } from "./types.ts";

export class Display {
  constructor(private readonly studio: Studio) {}

  /** Show another document from its beginning. */
  document(text: string): void {
    const { studio } = this;
    studio.document.begin(text);
    studio.tracks.selection.set([]);
    studio.gestures.begin(studio.isGesture);
    studio.textMode.begin(studio.isGesture);
    studio.textPane.show(text);
    studio.view.setMode("plan");
    studio.player.seek(0);
    studio.plan.now();
  }

  /** Show a change of the document, and plan it; typed text is shown already. */
  change(isTyped: boolean): void {
    const { studio } = this;
    if (!isTyped) studio.textPane.show(studio.document.text);
    studio.textPane.mark(null);
    if (isTyped) studio.plan.later();
    else studio.plan.soon();
    studio.files.saving.changed();
    this.buttons();
  }

  plan(draft: Draft): void {
    const { studio } = this;
    studio.textPane.mark(null);
    studio.view.motion = new Motion(draft, studio.about.robot.hinges.length);
    studio.player.duration = draft.duration;
    studio.tracks.drafted(draft);
    studio.timeline.show(draft, studio.tracks.selection.all);
    showNotices(draft, this.studio.about.gestures);
    studio.textMode.show(draft);
    studio.styles.preview.drafted(draft, studio.inspection.ids);
    studio.player.seek(Math.min(studio.player.time, draft.duration));
    if ("keys" in draft) studio.gestures.show(draft as GestureDraft);
    studio.inspection.show();
  }

  /** Show an error of the document at its line. */
  fault(fault: Fault): void {
    this.studio.textPane.mark(fault);
    showFault(fault);
    this.studio.textMode.failed();
  }

  selection(): void {
    const { plan, timeline, tracks, textPane, player, inspection } = this.studio;
    if (plan.draft) timeline.show(plan.draft, tracks.selection.all);
    if (tracks.selection.single) textPane.find(tracks.selection.single);
    timeline.at(player.time);
    inspection.show();
  }

  time(time: number): void {
    const { player, timeline, view, styles } = this.studio;
    showClock(time, player.duration, player.playing);
    timeline.at(time);
    view.move();
    styles.preview.at(time);
  }

  buttons(): void {
    enableButtons(this.studio.document, this.studio.robot);
  }
}
