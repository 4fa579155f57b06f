// Voice of a plan. It is the clock of the player, because ears are more sensitive to jumps than eyes.

const SCRUB_DURATION = 0.12; // [s] of sound at a drag of the time slider

export class Voice {
  on = true;
  private context: AudioContext | null = null;
  private buffer: AudioBuffer | null = null;
  private document: string | null = null; // document of the voice
  private source: AudioBufferSourceNode | null = null;
  private zero = 0; // [s] audio clock at performance time 0

  /** Whether the voice of a document is loaded, or switched off. */
  has(document: string): boolean {
    return !this.on || this.document === document;
  }

  /** Set the voice of a document, a WAV file in base64, or null without a voice. */
  async take(document: string, wav: string | null): Promise<void> {
    this.stop();
    this.document = document;
    this.context ??= new AudioContext();
    const bytes = wav === null ? null : Uint8Array.from(atob(wav), (letter) => letter.charCodeAt(0));
    this.buffer = bytes && (await this.context.decodeAudioData(bytes.buffer));
  }

  /** Start the voice at a performance time [s]. */
  start(document: string, time: number): void {
    this.speak(document, time);
  }

  /** Play a short piece at the present time. */
  scrub(document: string, time: number): void {
    this.speak(document, time, SCRUB_DURATION);
  }

  stop(): void {
    this.source?.stop();
    this.source = null;
  }

  /** Audible performance time [s]; null if nothing is audible. */
  get time(): number | null {
    if (!this.source || this.context?.state !== "running") return null;
    return this.context.currentTime - (this.context.outputLatency || 0) - this.zero;
  }

  private speak(document: string, time: number, length?: number): void {
    this.stop();
    const { buffer, context } = this;
    if (!this.on || !buffer || !context || this.document !== document || time >= buffer.duration) return;
    void context.resume(); // browsers allow sound only after a user action
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
