// Stage: the robot from any viewpoint, with draggable parts.
import { type Look, type Scene, sceneOf } from "kinesic:scene";
import { type Handle, Handles, handlePosition, type Part, type Point } from "./handles.ts";
import { lookFrom, TURNS, turned, type View, zoomed } from "./look.ts";
import { drawsInSoftware, Pace, type Quality, whenDrawn } from "./pace.ts";
import { SectorGrid } from "./sectors.ts";
import { type Shown, same } from "./shown.ts";
import { Sketch } from "./sketch.ts";
import type { Seen } from "./solid.ts";
import type { Body, Side } from "./types.ts";
import { unproject, type Vector } from "./vectors.ts";

export interface Drag extends Handle {
  /** [m] in the world. */
  target: Vector;
  /** [ms] time of the pointer event. */
  asked: number;
}

const MAX_LATENCIES = 500; // number of stored latencies
// Raw pointer events arrive without waiting for the next frame, where the browser supports them.
const MOVE_EVENT = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";

export class Stage {
  readonly flat: boolean;
  look: Look;
  drawn = 0;
  readonly sectors: SectorGrid;
  private readonly scene: Scene | null;
  private shown: Shown;
  /** [ms] from a pointer event until its posture is fully drawn. */
  readonly latencies: number[] = [];
  private readonly software = drawsInSoftware();
  private readonly pace = new Pace(this.software);
  private sketch: Sketch | null = null; // used during motion without a graphics card
  private readonly gl: WebGL2RenderingContext | null;
  private due = false; // a frame is requested
  private busy = false; // a frame is being drawn
  private settling = 0; // timer of a finer frame after motion
  private quality: Quality = { scale: 0, full: false }; // quality of the last frame
  private ink: readonly number[] = [0, 0, 0];
  private size = { width: 0, height: 0 }; // [CSS pixels] size of the stage
  private readonly handles: Handles;
  private dragged: (Handle & { grip: Vector }) | null = null;
  private last: Drag | null = null; // last event of the current drag
  private over: Handle | null = null;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly covers: { sketch: HTMLCanvasElement; grid: SVGSVGElement; dots: HTMLElement },
    private readonly body: Body,
    private readonly listener: { drag(drag: Drag): void; drop(drag: Drag): void },
  ) {
    this.scene = sceneOf(canvas, body, !this.software);
    this.gl = canvas.getContext("webgl2");
    this.sectors = new SectorGrid(covers.grid, body);
    this.handles = new Handles(covers.dots, body);
    this.flat = this.scene === null;
    this.look = lookFrom("free", body);
    this.shown = { angles: body.rest, ghost: undefined, lit: new Set() };
    this.listen();
  }

  /** Show the robot from a standard view. */
  view(view: View): void {
    this.look = lookFrom(view, this.body);
    this.redraw();
  }

  /** Show the robot in a posture; equal pictures are not drawn again. */
  show(shown: Shown): void {
    if (this.drawn && same(shown, this.shown)) return;
    this.shown = shown;
    this.pace.move(performance.now());
    if (shown.asked === undefined || this.waits) this.redraw();
    else this.draw(performance.now());
  }

  /** Request a frame; repeated requests are merged, and only one frame is drawn at a time. */
  redraw(): void {
    this.pace.move(performance.now());
    if (this.due) return;
    this.due = true;
    if (!this.waits) requestAnimationFrame((now) => this.due && this.draw(now));
  }

  /** Return the position of a handle on the page [CSS pixels]. */
  handleOnPage(part: Part, side: Side = "right"): Point | null {
    const area = this.canvas.getBoundingClientRect();
    const k = this.handles.all.findIndex((each) => each.part === part && each.side === side);
    const at = this.points()[k];
    return at ? { x: area.left + at.x, y: area.top + at.y } : null;
  }

  /** Return the world position [m] of a hand in the shown posture; null if nothing is drawn. */
  handPosition(side: Side, angles = this.shown.angles): Vector | null {
    if (!this.scene) return null;
    const [x, y, z] = handlePosition(this.body, { part: "hand", side }, this.scene.frames(angles));
    const [ux, uy, uz] = this.scene.up;
    return [x - ux, y - uy, z - uz];
  }

  /** Return the viewpoint of the shown posture; null if nothing is drawn. */
  private seen(): Seen | null {
    const { scene } = this;
    return scene && { ...scene.camera(this.look, this.size), frames: scene.frames(this.shown.angles) };
  }

  private points(seen = this.seen()): Point[] {
    return seen ? this.handles.points(seen.view, seen.frames, this.size) : [];
  }

  /** Whether changes must wait for the current frame; a sketch never waits. */
  private get waits(): boolean {
    return this.busy && !this.sketch;
  }

  private draw(now: number): void {
    this.due = false;
    if (this.dragged) this.pace.move(now);
    const moving = this.pace.untilStill(now) > 0;
    this.quality = this.pace.quality(now);
    const { angles, ghost, lit, strain, asked } = this.shown;
    const picture = {
      look: this.look,
      twin: { angles, ...(strain && { duty: strain }) },
      ghost,
      beside: false,
      ink: this.ink,
      lit,
      ...this.quality,
    };
    const frame = ++this.drawn;
    const began = performance.now();
    const sketch = moving ? this.sketch : null;
    const seen = this.seen();
    if (sketch && seen) sketch.draw(picture, seen, this.size, this.quality.scale);
    else this.scene?.draw(picture);
    if (this.scene && seen) this.drawCovers(this.scene.up, seen);
    if (sketch) {
      this.finish(performance.now() - began, moving, asked);
      return;
    }
    this.busy = true;
    whenDrawn(this.gl, () => {
      this.busy = false;
      if (frame === this.drawn) this.sketch?.hide();
      this.finish(performance.now() - began, moving, asked);
    });
  }

  private drawCovers(up: Vector, seen: Seen): void {
    const hand = this.last?.part === "hand" ? this.last : null;
    const { side, target } = hand ?? { side: "right", target: null };
    this.sectors.draw(seen.view, up, side, target, this.size);
    this.handles.draw(this.points(seen), this.dragged ?? this.over, this.dragged !== null);
  }

  /**
   * Judge the drawn frame and draw later changes.
   * @param took duration [ms]
   * @param moving whether the duration influences the quality of the next frame
   * @param asked time [ms] of the pointer event that requested the posture, if any
   */
  private finish(took: number, moving: boolean, asked: number | undefined): void {
    const now = performance.now();
    if (moving) this.pace.learn(took);
    if (asked !== undefined) {
      this.latencies.push(now - asked);
      this.latencies.splice(0, this.latencies.length - MAX_LATENCIES);
      if (this.shown.asked === asked) delete this.shown.asked;
    }
    if (this.due) {
      this.pace.move(now); // it has changed during this frame
      this.draw(now);
      return;
    }
    if (!moving) this.prepareSketch();
    this.settle(now);
  }

  /** After the first frame, draw motion as sketches if they are faster. */
  private prepareSketch(): void {
    if (!this.software || this.sketch || !this.scene?.shapes) return;
    this.sketch = new Sketch(this.covers.sketch, this.scene, this.scene.shapes, this.body);
  }

  /** Draw in full quality after motion. */
  private settle(now: number): void {
    clearTimeout(this.settling);
    if (this.dragged) return;
    const wait = this.pace.untilStill(now);
    const { scale, full } = this.pace.quality(now + Math.max(wait, 0));
    if (scale === this.quality.scale && full === this.quality.full) return;
    this.settling = setTimeout(() => this.busy || this.draw(performance.now()), wait);
  }

  /** Read the size of the stage once for many frames, because each read causes a layout. */
  private measure(): void {
    this.size = { width: this.canvas.clientWidth, height: this.canvas.clientHeight };
    this.redraw();
  }

  private readInk(): void {
    const read = getComputedStyle(this.canvas).color.match(/[\d.]+/g);
    this.ink = read?.slice(0, 3).map((value) => Number(value) / 255) ?? [0, 0, 0];
    this.redraw();
  }

  private point(event: PointerEvent | MouseEvent): { x: number; y: number } {
    const area = this.canvas.getBoundingClientRect();
    return {
      x: (2 * (event.clientX - area.left)) / area.width - 1,
      y: 1 - (2 * (event.clientY - area.top)) / area.height,
    };
  }

  private under(event: PointerEvent): Handle | null {
    const area = this.canvas.getBoundingClientRect();
    return this.handles.under(this.points(), { x: event.clientX - area.left, y: event.clientY - area.top });
  }

  private listen(): void {
    const { canvas } = this;
    new ResizeObserver(() => this.measure()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.readInk());
    this.readInk();
    canvas.addEventListener("webglcontextrestored", () => this.redraw());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      const handle = this.under(event);
      const frames = this.scene?.frames(this.shown.angles);
      this.dragged = handle && frames ? { ...handle, grip: handlePosition(this.body, handle, frames) } : null;
      if (this.dragged) canvas.addEventListener(MOVE_EVENT, this.follow);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.dragged) return;
      if (event.buttons & 1 && canvas.hasPointerCapture(event.pointerId)) this.orbit(event);
      else this.hover(this.under(event));
    });
    for (const kind of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(kind, () => {
        canvas.removeEventListener(MOVE_EVENT, this.follow);
        if (this.last) this.listener.drop(this.last);
        this.dragged = this.last = null;
        this.redraw();
      });
    canvas.addEventListener("wheel", (event) => this.zoom(event), { passive: false });
    canvas.addEventListener("dblclick", () => this.view("free"));
    canvas.addEventListener("keydown", (event) => this.turnByKey(event));
  }

  private readonly follow = (event: Event): void => {
    if (this.dragged && event instanceof PointerEvent) this.dragTo(event, this.dragged);
  };

  private dragTo(event: PointerEvent, { part, side, grip }: Handle & { grip: Vector }): void {
    if (!this.scene) return;
    const { eye, view } = this.scene.camera(this.look, this.size);
    const { x, y } = this.point(event);
    const place = unproject(view, eye, x, y, grip);
    const [ux, uy, uz] = this.scene.up;
    this.last = { part, side, target: [place[0] - ux, place[1] - uy, place[2] - uz], asked: event.timeStamp };
    this.listener.drag(this.last);
  }

  private orbit(event: PointerEvent): void {
    this.look = turned(this.look, -0.008 * event.movementX, 0.008 * event.movementY);
    this.redraw();
  }

  private hover(handle: Handle | null): void {
    if (handle === this.over) return;
    this.over = handle;
    this.canvas.style.cursor = handle ? "grab" : "";
    this.canvas.title = handle ? `Drag: ${handle.part === "gaze" ? "where it looks" : handle.part}` : "";
    this.redraw();
  }

  private zoom(event: WheelEvent): void {
    event.preventDefault();
    this.zoomBy(Math.exp(-0.0015 * event.deltaY));
  }

  private zoomBy(factor: number): void {
    this.look = zoomed(this.look, factor);
    this.redraw();
  }

  private turnByKey(event: KeyboardEvent): void {
    if (event.key === "+" || event.key === "-") this.zoomBy(event.key === "+" ? 1.1 : 1 / 1.1);
    const turn = TURNS[event.key];
    if (!turn) return;
    event.preventDefault();
    this.look = turned(this.look, ...turn);
    this.redraw();
  }
}
