// Plays the selected behaviour once after its expressivity was changed, with the former plan as a ghost.
import { byId } from "../dom.ts";
import type { Motion } from "../motion.ts";
import type { Player } from "../player.ts";
import type { Draft } from "../types.ts";
import type { StageView } from "../view.ts";
import { BLOCK } from "../xml.ts";

const MARGIN = 0.2; // [s] before the start and after the end of a behaviour

export class Preview {
  private readonly on = byId<HTMLInputElement>("play-changes");
  private before: Motion | null = null; // motion before the change that is not drafted yet
  private end: number | null = null; // [s] at which the playback of a change ends

  constructor(
    private readonly view: Pick<StageView, "motion" | "before" | "setMode">,
    private readonly player: Pick<Player, "playing" | "seek" | "play">,
  ) {
    this.on.checked = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  }

  /** Expect the draft of changed expressivity. */
  expect(): void {
    if (this.on.checked) this.before = this.view.motion;
  }

  /** Play no change whose draft is still expected, because the robot performs. */
  cancel(): void {
    this.view.before = this.before = null;
    this.end = null;
  }

  /** Play the changed behaviours, if this draft has their change. */
  drafted(draft: Draft, ids: readonly string[]): void {
    const { before } = this;
    this.view.before = this.before = null;
    this.end = null;
    const span = before && spanOf(draft, ids);
    if (!span) return;
    this.view.setMode("plan");
    this.view.before = before;
    this.player.seek(Math.max(0, span.start - MARGIN));
    this.end = Math.min(span.end + MARGIN, draft.duration);
    this.player.play(true);
  }

  /** End the playback of a change at the end of its behaviour. */
  at(time: number): void {
    if (this.end === null || (this.player.playing && time < this.end)) return;
    this.end = null;
    this.view.before = null;
    if (this.player.playing) this.player.play(false);
  }
}

/** Return the planned start and end [s] of behaviours or of the whole block; null without times. */
function spanOf(draft: Draft, ids: readonly string[]): { start: number; end: number } | null {
  if (ids.includes(BLOCK)) return { start: 0, end: draft.duration };
  const times = draft.syncs.filter(({ behaviour }) => ids.includes(behaviour)).map(({ planned }) => planned);
  return times.length ? { start: Math.min(...times), end: Math.max(...times) } : null;
}
