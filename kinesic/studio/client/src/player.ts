// Plays a plan on the page alone: time goes on, and whoever listens shows that moment.

export class Player {
  time = 0;
  duration = 0;
  playing = false;
  loops = false;
  private last = 0;

  constructor(private readonly show: (time: number) => void) {}

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.show(this.time);
  }

  play(on: boolean): void {
    const begins = on && !this.playing;
    this.playing = on;
    if (on && this.time >= this.duration) this.time = 0;
    this.last = performance.now();
    this.show(this.time);
    if (begins) requestAnimationFrame((now) => this.tick(now));
  }

  private tick(now: number): void {
    if (!this.playing) return;
    this.time += Math.max(0, now - this.last) / 1000;
    this.last = now;
    if (this.time >= this.duration) {
      this.time = this.loops ? 0 : this.duration;
      this.playing = this.loops;
    }
    this.show(this.time);
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
  }
}
