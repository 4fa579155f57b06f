// The stage: the robot from any side, and parts of its body that can be dragged.
import { type Look, type Scene, sceneOf } from "kinesic:scene";
import { type Handle, Handles, type Part, type Point, placeOf } from "./handles.ts";
import { SectorGrid } from "./sectors.ts";
import type { Body, Side } from "./types.ts";
import { unproject, type Vector } from "./vectors.ts";

export const VIEWS = ["front", "left", "top", "free"] as const;
export type View = (typeof VIEWS)[number];

export interface Drag extends Handle {
  /** [m] in the world. */
  target: Vector;
}

export interface Shown {
  angles: readonly number[];
  ghost: readonly number[] | undefined;
  lit: ReadonlySet<number>;
  /** How far each hinge is from its plan, 1: very far; it is red from a half on. */
  strain?: readonly number[];
}

export class Stage {
  readonly flat: boolean;
  look: Look;
  drawn = 0;
  readonly sectors: SectorGrid;
  private readonly scene: Scene | null;
  private shown: Shown;
  private due = false;
  private readonly handles: Handles;
  private dragged: (Handle & { grip: Vector }) | null = null;
  private last: Drag | null = null; // of the part that is dragged
  private over: Handle | null = null;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    grid: SVGSVGElement,
    dots: SVGSVGElement,
    private readonly body: Body,
    private readonly listener: { drag(drag: Drag): void; drop(drag: Drag): void },
  ) {
    this.scene = sceneOf(canvas, body);
    this.sectors = new SectorGrid(grid, body);
    this.handles = new Handles(dots, body);
    this.flat = this.scene === null;
    this.look = this.lookOf("free");
    this.shown = { angles: body.rest, ghost: undefined, lit: new Set() };
    this.listen();
  }

  /** Shows the robot from one of the usual sides. */
  view(view: View): void {
    this.look = this.lookOf(view);
    this.redraw();
  }

  show(shown: Shown): void {
    this.shown = shown;
    this.redraw();
  }

  /** Draws at the next chance, however often it is asked. */
  redraw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => this.draw());
  }

  /** Where a part can be taken, on the page [CSS pixels]. */
  handleAt(part: Part, side: Side = "right"): Point | null {
    const area = this.canvas.getBoundingClientRect();
    const k = this.handles.all.findIndex((each) => each.part === part && each.side === side);
    const at = this.points()[k];
    return at ? { x: area.left + at.x, y: area.top + at.y } : null;
  }

  /** Where a hand is [m] in the world, in the posture that is shown; null where nothing is drawn. */
  placeOfHand(side: Side): Vector | null {
    if (!this.scene) return null;
    const [x, y, z] = placeOf(this.body, { part: "hand", side }, this.scene.frames(this.shown.angles));
    const [ux, uy, uz] = this.scene.up as [number, number, number];
    return [x - ux, y - uy, z - uz];
  }

  private points(): Point[] {
    if (!this.scene) return [];
    const area = this.canvas.getBoundingClientRect();
    return this.handles.points(this.scene.camera(this.look).view, this.scene.frames(this.shown.angles), area);
  }

  private lookOf(view: View): Look {
    const [x, y, z] = this.body.view.from as [number, number, number];
    const free = { turn: Math.atan2(y, x), rise: Math.asin(z / Math.hypot(x, y, z)), zoom: 1 };
    const sides: Record<View, Look> = {
      free,
      front: { turn: 0, rise: 0.05, zoom: 1 },
      left: { turn: Math.PI / 2, rise: 0.05, zoom: 1 },
      top: { turn: 0, rise: 1.5, zoom: 1 },
    };
    return sides[view];
  }

  private draw(): void {
    this.due = false;
    const ink = getComputedStyle(this.canvas)
      .color.match(/[\d.]+/g)
      ?.slice(0, 3)
      .map((value) => Number(value) / 255);
    this.scene?.draw({
      look: this.look,
      twin: { angles: this.shown.angles, ...(this.shown.strain && { duty: this.shown.strain }) },
      ghost: this.shown.ghost,
      beside: false,
      ink: ink ?? [0, 0, 0],
      lit: this.shown.lit,
    });
    if (this.scene) {
      const hand = this.last?.part === "hand" ? this.last : null;
      const { side, target } = hand ?? { side: "right", target: null };
      this.sectors.draw(this.scene.camera(this.look).view, this.scene.up, side, target);
      this.handles.draw(this.points(), this.dragged ?? this.over);
    }
    this.drawn += 1;
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
    new ResizeObserver(() => this.redraw()).observe(canvas);
    canvas.addEventListener("webglcontextrestored", () => this.redraw());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      const handle = this.under(event);
      const frames = this.scene?.frames(this.shown.angles);
      this.dragged = handle && frames ? { ...handle, grip: placeOf(this.body, handle, frames) } : null;
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.dragged) this.dragTo(event, this.dragged);
      else if (event.buttons & 1 && canvas.hasPointerCapture(event.pointerId)) this.orbit(event);
      else this.hover(this.under(event));
    });
    for (const kind of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(kind, () => {
        if (this.last) this.listener.drop(this.last);
        this.dragged = this.last = null;
        this.redraw();
      });
    canvas.addEventListener("wheel", (event) => this.zoom(event), { passive: false });
    canvas.addEventListener("dblclick", () => this.view("free"));
    canvas.addEventListener("keydown", (event) => this.turnByKey(event));
  }

  private dragTo(event: PointerEvent, { part, side, grip }: Handle & { grip: Vector }): void {
    if (!this.scene) return;
    const { eye, view } = this.scene.camera(this.look);
    const { x, y } = this.point(event);
    const [ex, ey, ez] = eye as [number, number, number];
    const place = unproject(view, [ex, ey, ez], x, y, grip);
    const [ux, uy, uz] = this.scene.up as [number, number, number];
    this.last = { part, side, target: [place[0] - ux, place[1] - uy, place[2] - uz] };
    this.listener.drag(this.last);
  }

  private orbit(event: PointerEvent): void {
    this.look = {
      turn: this.look.turn - 0.008 * event.movementX,
      rise: Math.min(Math.max(this.look.rise + 0.008 * event.movementY, -0.1), 1.5),
      zoom: this.look.zoom,
    };
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
    this.look = { ...this.look, zoom: Math.min(Math.max(this.look.zoom * factor, 0.5), 6) };
    this.redraw();
  }

  private turnByKey(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [0.1, 0],
      ArrowRight: [-0.1, 0],
      ArrowUp: [0, 0.1],
      ArrowDown: [0, -0.1],
    };
    const turn = turns[event.key];
    if (event.key === "+" || event.key === "-") this.zoomBy(event.key === "+" ? 1.1 : 1 / 1.1);
    if (!turn) return;
    event.preventDefault();
    this.look = {
      turn: this.look.turn + turn[0],
      rise: Math.min(Math.max(this.look.rise + turn[1], -0.1), 1.5),
      zoom: this.look.zoom,
    };
    this.redraw();
  }
}
