// Motion of a draft at any time.
import type { Draft } from "./types.ts";

export class Motion {
  private readonly rows: Float32Array;

  constructor(
    private readonly draft: Draft,
    private readonly hinges: number,
  ) {
    const bytes = Uint8Array.from(atob(draft.angles), (letter) => letter.charCodeAt(0));
    this.rows = new Float32Array(bytes.buffer);
  }

  /** Interpolated angles [rad] at a time [s]. */
  at(time: number): number[] {
    const count = this.rows.length / this.hinges;
    const place = Math.min(Math.max(time * this.draft.rate, 0), count - 1);
    const low = Math.floor(place);
    const high = Math.min(low + 1, count - 1);
    return Array.from({ length: this.hinges }, (_, k) => {
      const [a, b] = [this.rows[low * this.hinges + k]!, this.rows[high * this.hinges + k]!];
      return a + (b - a) * (place - low);
    });
  }
}
