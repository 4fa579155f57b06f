// What the stage shows: the plan at a moment, the robot as it is, or the posture of what is dragged.
import { byId, say } from "./dom.ts";
import type { Motion } from "./motion.ts";
import { Reaching } from "./reaching.ts";
import type { Robot } from "./robot.ts";
import { type Drag, Stage } from "./stage.ts";
import { type Measure, strainOf } from "./telemetry.ts";
import type { About, BodyReport, Reached } from "./types.ts";

export class StageView {
  readonly stage: Stage;
  mode: "plan" | "robot" = "plan";
  motion: Motion | null = null;
  private readonly reaching: Reaching;

  constructor(
    private readonly about: About,
    private readonly robot: Robot,
    private readonly time: () => number,
    dropped: (drag: Drag) => void,
  ) {
    const covers = {
      sketch: byId<HTMLCanvasElement>("sketch"),
      grid: byId<SVGSVGElement>("sectors"),
      dots: byId("handles"),
    };
    this.stage = new Stage(byId<HTMLCanvasElement>("canvas"), covers, about.robot, {
      drag: (drag) => this.reaching.drag(drag),
      drop: (drag) => {
        this.reaching.drop();
        dropped(drag);
      },
    });
    this.reaching = new Reaching(
      about.robot,
      robot.wire,
      (found, asked) => this.reached(found, asked),
      () => this.posture(),
    );
    byId("measure").addEventListener("change", () => this.redraw());
  }

  /** Shows another moment: what was dragged is forgotten. */
  move(): void {
    this.reaching.forget();
    this.redraw();
  }

  become(mode: "plan" | "robot"): void {
    this.mode = mode;
    for (const name of ["plan", "robot"]) byId(`mode-${name}`).setAttribute("aria-pressed", String(name === mode));
    this.move();
  }

  /** Shows the robot where it is now, if that is what is shown. */
  follow(): void {
    if (this.mode === "robot") this.redraw();
  }

  showSectors(on: boolean): void {
    this.stage.sectors.shown = on;
    this.stage.redraw(); // also where the robot looks as before
  }

  private redraw(asked?: number): void {
    const { report } = this;
    const { lit, shown } = this.reaching;
    const angles = shown ?? this.posture();
    if (report && !shown) this.stage.show({ angles, ghost: report.planned, lit, strain: this.strain(report) });
    else this.stage.show({ angles, ghost: undefined, lit, ...(asked !== undefined && { asked }) });
  }

  private get report(): BodyReport | null {
    return this.mode === "robot" ? this.robot.report : null;
  }

  private strain(report: BodyReport): number[] {
    const measure = byId<HTMLSelectElement>("measure").value as Measure;
    return strainOf(this.about.robot, report, this.robot.places, measure);
  }

  /** The posture [rad] that is shown where nothing is dragged; a servo that does not answer is where it should be. */
  private posture(): readonly number[] {
    const { report } = this;
    if (report) return report.angles.map((angle, k) => angle ?? report.planned[k]!);
    return this.motion?.at(this.time()) ?? this.about.robot.rest;
  }

  private reached(found: Reached | null, asked?: number): void {
    say(byId("stops"), this.reaching.words(found));
    byId("stops").classList.toggle("warning", found !== null && !found.reached);
    this.redraw(asked);
  }

  /** What tests and curious people may read. */
  state(): Record<string, unknown> {
    const { stage } = this;
    return {
      mode: this.mode,
      drawn: stage.drawn,
      flat: stage.flat,
      left: stage.handleAt("hand", "left"),
      right: stage.handleAt("hand", "right"),
      elbow: stage.handleAt("elbow", "left"),
      trunk: stage.handleAt("trunk"),
      gaze: stage.handleAt("gaze"),
      reach: this.reaching.found,
      latencies: stage.latencies,
    };
  }
}
