// Playback of the plan with its voice.
import type { Exports } from "./exports.ts";
import { Player } from "./player.ts";
import { Voice } from "./voice.ts";

export class Playback {
  readonly player: Player;
  readonly voice = new Voice();

  constructor(
    private readonly exports: Exports,
    private readonly document: () => string,
    show: (time: number) => void,
  ) {
    this.player = new Player(show, {
      start: (time) => this.voice.start(this.document(), time),
      scrub: (time) => this.voice.scrub(this.document(), time),
      stop: () => this.voice.stop(),
      read: () => this.voice.time,
    });
  }

  /** Play or pause; request the voice first if the document speaks. */
  async toggle(speaks: boolean): Promise<void> {
    const document = this.document();
    if (!this.player.playing && speaks && !this.voice.has(document))
      await this.voice.take(document, await this.exports.voice(document));
    this.player.play(!this.player.playing);
  }

  speak(on: boolean): void {
    this.voice.on = on;
    if (!on) this.voice.stop();
  }
}
