// Drawing quality of the stage: as fine as the machine allows during motion, fine at rest.

/** Quality of a frame. */
export interface Quality {
  /** Canvas pixels per CSS pixel. */
  scale: number;
  /** Whether all triangles and shadows are drawn. */
  full: boolean;
}

const RESOLUTIONS = [1, 0.7, 0.5] as const; // resolution factors during motion
const SLOW_FRAME_TIME = 16; // [ms] frame time above which the next frame is coarser, one refresh of a 60 Hz screen
const MAX_FRAME_TIME = 35; // [ms] upper limit of a counted frame time, so that one interruption does not matter
const POLL_INTERVAL = 2; // [ms] between two polls for the end of a frame
const STILL_DELAY = 250; // [ms] after the last change until the stage counts as still
const FRAME_WEIGHT = 0.3; // weight of the last frame in the smoothed frame time

/** Whether the browser draws without a graphics card. */
export function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const about = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl?.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** Call back when the GPU has drawn everything. */
export function whenDrawn(gl: WebGL2RenderingContext | null, done: () => void): void {
  const fence = gl?.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0) ?? null;
  gl?.flush();
  const look = () => {
    if (fence && gl?.clientWaitSync(fence, 0, 0) === gl?.TIMEOUT_EXPIRED) setTimeout(look, POLL_INTERVAL);
    else {
      gl?.deleteSync(fence);
      done();
    }
  };
  setTimeout(look, 0);
}

export class Pace {
  private step = 0;
  private took = 0; // [ms] smoothed frame time
  private moved = Number.NEGATIVE_INFINITY; // [ms] time of the last change

  /** @param software whether edges are smoothed by supersampling at rest only */
  constructor(private readonly software: boolean) {}

  /** Note a change at a time [ms]. */
  move(now: number): void {
    this.moved = now;
  }

  /** Return the time [ms] until the stage counts as still; not positive if it already does. */
  untilStill(now: number): number {
    return this.moved + STILL_DELAY - now;
  }

  quality(now: number): Quality {
    const full = Math.min(globalThis.devicePixelRatio || 1, 2);
    if (this.untilStill(now) <= 0) return { scale: this.software ? 2 : full, full: true };
    return { scale: full * RESOLUTIONS[this.step]!, full: !this.software && this.step === 0 };
  }

  /** Note the duration [ms] of a frame during motion. */
  learn(took: number): void {
    const counts = Math.min(took, MAX_FRAME_TIME);
    this.took = this.took ? this.took + FRAME_WEIGHT * (counts - this.took) : counts;
    const finer =
      this.step > 0 ? (RESOLUTIONS[this.step - 1]! / RESOLUTIONS[this.step]!) ** 2 : Number.POSITIVE_INFINITY;
    const step =
      this.took > SLOW_FRAME_TIME ? this.step + 1 : this.took * finer < SLOW_FRAME_TIME / 2 ? this.step - 1 : this.step;
    if (step === this.step || step >= RESOLUTIONS.length) return;
    this.step = step;
    this.took = 0;
  }
}
