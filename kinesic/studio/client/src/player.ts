// Player of a plan: advances the time and notifies a listener.

/** Sound played along with the plan; its clock overrides the page's. */
export interface Sound {
  start(time: number): void;
  scrub(time: number): void;
  stop(): void;
  /** Audible performance time [s]; null if nothing is audible. */
  read(): number | null;
}

export class Player {
  time = 0;
  duration = 0;
  playing = false;
  loops = false;
  private last = 0;

  constructor(
    private readonly show: (time: number) => void,
    private readonly sound: Sound,
  ) {}

  seek(time: number): void {
    const moved = time !== this.time;
    this.time = Math.min(Math.max(time, 0), this.duration);
    if (this.playing) this.sound.start(this.time);
    else if (moved) this.sound.scrub(this.time);
    this.show(this.time);
  }

  /** Show a time [s] that another clock tells, without sound. */
  follow(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.show(this.time);
  }

  play(on: boolean): void {
    const begins = on && !this.playing;
    this.playing = on;
    if (on && this.time >= this.duration) this.time = 0;
    this.last = performance.now();
    this.show(this.time);
    if (begins) {
      this.sound.start(this.time);
      requestAnimationFrame((now) => this.tick(now));
    } else if (!on) this.sound.stop();
  }

  private tick(now: number): void {
    if (!this.playing) return;
    this.time = Math.max(this.time, this.sound.read() ?? this.time + Math.max(0, now - this.last) / 1000);
    this.last = now;
    if (this.time >= this.duration) this.end();
    this.show(this.time);
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
  }

  private end(): void {
    this.time = this.loops ? 0 : this.duration;
    this.playing = this.loops;
    if (this.loops) this.sound.start(0);
    else this.sound.stop();
  }
}
