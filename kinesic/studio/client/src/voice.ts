// The voice of a plan: heard while it plays, and then the clock of the player, for ears notice what eyes forgive.

const GRAIN = 0.12; // [s] that are heard where somebody drags the slider

export class Voice {
  on = true;
  private context: AudioContext | null = null;
  private buffer: AudioBuffer | null = null;
  private document: string | null = null; // whose voice it is
  private source: AudioBufferSourceNode | null = null;
  private zero = 0; // [s] of the context's clock at which performance time is 0

  /** Whether the voice of a document is here, or is not wanted. */
  has(document: string): boolean {
    return !this.on || this.document === document;
  }

  /** Takes the voice of a document: a WAV file in base64; null where it has none. */
  async take(document: string, wav: string | null): Promise<void> {
    this.stop();
    this.document = document;
    this.context ??= new AudioContext();
    const bytes = wav === null ? null : Uint8Array.from(atob(wav), (letter) => letter.charCodeAt(0));
    this.buffer = bytes && (await this.context.decodeAudioData(bytes.buffer));
  }

  /** Begins to speak at a performance time [s]. */
  start(document: string, time: number): void {
    this.speak(document, time);
  }

  /** Lets the moment be heard. */
  scrub(document: string, time: number): void {
    this.speak(document, time, GRAIN);
  }

  stop(): void {
    this.source?.stop();
    this.source = null;
  }

  /** Performance time [s] that is heard now; null where nothing is. */
  get time(): number | null {
    if (!this.source || this.context?.state !== "running") return null;
    return this.context.currentTime - (this.context.outputLatency || 0) - this.zero;
  }

  private speak(document: string, time: number, length?: number): void {
    this.stop();
    const { buffer, context } = this;
    if (!this.on || !buffer || !context || this.document !== document || time >= buffer.duration) return;
    void context.resume(); // a browser lets pages be heard once somebody has pressed something
    const source = context.createBufferSource();
    source.buffer = buffer;
    source.connect(context.destination);
    source.addEventListener("ended", () => {
      if (this.source === source) this.source = null;
    });
    source.start(0, Math.max(time, 0), length);
    this.zero = context.currentTime - time;
    this.source = source;
  }
}
