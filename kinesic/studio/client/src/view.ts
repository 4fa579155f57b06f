// Contents of the stage: the plan at a time, the actual robot, or a dragged posture.
import { byId, say } from "./dom.ts";
import type { Motion } from "./motion.ts";
import { Reaching } from "./reaching.ts";
import type { Robot } from "./robot.ts";
import { type Drag, Stage } from "./stage.ts";
import { computeStrain, type Measure } from "./telemetry.ts";
import type { About, BodyReport, Reached } from "./types.ts";

export class StageView {
  readonly stage: Stage;
  mode: "plan" | "robot" = "plan";
  motion: Motion | null = null;
  /** Motion before a change, shown as a ghost while the change is played. */
  before: Motion | null = null;
  private readonly reaching: Reaching;

  constructor(
    private readonly about: About,
    private readonly robot: Robot,
    private readonly time: () => number,
    private readonly listener: {
      /** A dragged part was released. */
      dropped(drag: Drag): void;
      /** The dragged part has reached a posture [rad]. */
      reached(angles: readonly number[]): void;
    },
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
        listener.dropped(drag);
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

  /** Show another time and forget the drag. */
  move(): void {
    this.reaching.forget();
    this.redraw();
  }

  setMode(mode: "plan" | "robot"): void {
    this.mode = mode;
    for (const name of ["plan", "robot"]) byId(`mode-${name}`).setAttribute("aria-pressed", String(name === mode));
    this.move();
  }

  /** Show the actual robot, if it is the selected mode. */
  follow(): void {
    if (this.mode === "robot") this.redraw();
  }

  showSectors(on: boolean): void {
    this.stage.sectors.shown = on;
    this.stage.redraw(); // also when the robot looks the same
  }

  private redraw(asked?: number): void {
    const { report } = this;
    const { lit, shown } = this.reaching;
    const angles = shown ?? this.posture();
    if (report && !shown) this.stage.show({ angles, ghost: report.planned, lit, strain: this.strain(report) });
    else
      this.stage.show({
        angles,
        ghost: shown ? undefined : this.before?.at(this.time()),
        lit,
        ...(asked !== undefined && { asked }),
      });
  }

  private get report(): BodyReport | null {
    return this.mode === "robot" ? this.robot.shown : null;
  }

  private strain(report: BodyReport): number[] {
    const measure = byId<HTMLSelectElement>("measure").value as Measure;
    return computeStrain(this.about.robot, report, this.robot.places, measure);
  }

  /** Posture [rad] shown without a drag; a servo that does not answer is shown at its planned angle. */
  private posture(): readonly number[] {
    const { report } = this;
    if (report) return report.angles.map((angle, k) => angle ?? report.planned[k]!);
    return this.motion?.at(this.time()) ?? this.about.robot.rest;
  }

  private reached(found: Reached | null, asked?: number): void {
    if (found) this.listener.reached(found.angles);
    say(byId("stops"), this.reaching.words(found));
    byId("stops").classList.toggle("warning", found !== null && !found.reached);
    this.redraw(asked);
  }

  /** State for tests and debugging. */
  state(): Record<string, unknown> {
    const { stage } = this;
    return {
      mode: this.mode,
      drawn: stage.drawn,
      flat: stage.flat,
      left: stage.handleOnPage("hand", "left"),
      right: stage.handleOnPage("hand", "right"),
      elbow: stage.handleOnPage("elbow", "left"),
      trunk: stage.handleOnPage("trunk"),
      gaze: stage.handleOnPage("gaze"),
      reach: this.reaching.found,
      latencies: stage.latencies,
    };
  }
}
