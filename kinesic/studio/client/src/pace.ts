// How finely the stage is drawn: as finely as the machine can draw in time while something moves, finely once it is still.

/** How a frame is drawn. */
export interface Quality {
  /** Pixels of the canvas for each CSS pixel. */
  scale: number;
  /** Whether every triangle is drawn, and shadows. */
  full: boolean;
}

const SHARES = [1, 0.7, 0.5] as const; // of the resolution, while something moves
const LONG = 16; // [ms] a frame may take until the next one is coarser: as long as a screen shows one
const LONGEST = 35; // [ms] that counts, so that one frame of a machine that was away does not decide
const LOOK = 2; // [ms] between two looks whether a frame is drawn
const STILL = 250; // [ms] after the last change
const FOLLOWS = 0.3; // share of the last frame in what frames take

/** Whether the browser draws without a graphics card. */
export function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const about = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl?.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** Calls back when all that was asked of the card is drawn, to the last pixel. */
export function whenDrawn(gl: WebGL2RenderingContext | null, done: () => void): void {
  const fence = gl?.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0) ?? null;
  gl?.flush();
  const look = () => {
    if (fence && gl?.clientWaitSync(fence, 0, 0) === gl?.TIMEOUT_EXPIRED) setTimeout(look, LOOK);
    else {
      gl?.deleteSync(fence);
      done();
    }
  };
  setTimeout(look, 0);
}

export class Pace {
  private step = 0;
  private took = 0; // [ms] of the last frames
  private moved = Number.NEGATIVE_INFINITY; // [ms] when something changed

  /** @param software whether edges are smooth by drawing four pixels for one when all is still, instead of always */
  constructor(private readonly software: boolean) {}

  /** Something has changed at a time [ms]. */
  move(now: number): void {
    this.moved = now;
  }

  /** [ms] until all counts as still; not positive: it does. */
  untilStill(now: number): number {
    return this.moved + STILL - now;
  }

  quality(now: number): Quality {
    const full = Math.min(globalThis.devicePixelRatio || 1, 2);
    if (this.untilStill(now) <= 0) return { scale: this.software ? 2 : full, full: true };
    return { scale: full * SHARES[this.step]!, full: !this.software && this.step === 0 };
  }

  /** A frame of something that moves has taken so long [ms]. */
  learn(took: number): void {
    const counts = Math.min(took, LONGEST);
    this.took = this.took ? this.took + FOLLOWS * (counts - this.took) : counts;
    const finer = this.step > 0 ? (SHARES[this.step - 1]! / SHARES[this.step]!) ** 2 : Number.POSITIVE_INFINITY;
    const step = this.took > LONG ? this.step + 1 : this.took * finer < LONG / 2 ? this.step - 1 : this.step;
    if (step === this.step || step >= SHARES.length) return;
    this.step = step;
    this.took = 0;
  }
}
