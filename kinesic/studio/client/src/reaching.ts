// Drag of a body part: requests postures from the server one at a time, and names what stops the part.

import { readReached } from "./checks.ts";
import type { Part } from "./handles.ts";
import { findSector } from "./sectors.ts";
import type { Drag } from "./stage.ts";
import type { Body, Reached, Side } from "./types.ts";
import type { Wire } from "./wire.ts";

// [ms] between two requests. The server reads a client 50 times a second on average; more frequent
// requests each wait 20 ms.
const PERIOD = 21;
const FREE = { elbow: "the elbow can swing there", trunk: "the trunk can lean there", gaze: "the eyes can look there" };
const plain = (name: string) => name.replace(/^l_/, "left ").replace(/^r_/, "right ").replaceAll("_", " ");

export class Reaching {
  found: Reached | null = null;
  private next: Drag | null = null;
  private busy = false;
  private cancelled = 0; // number of cancelled drags; later answers to them are ignored
  private posture: number[] | null = null;
  private side: Side = "left";
  private part: Part = "hand";
  private target: readonly number[] = [0, 0, 0];

  constructor(
    private readonly body: Body,
    private readonly wire: Wire,
    private readonly changed: (found: Reached | null, asked?: number) => void,
    private readonly startPosture: () => readonly number[],
  ) {}

  /** Posture shown instead of all others; null without a drag. */
  get shown(): readonly number[] | null {
    return this.posture;
  }

  /** Segments that stop the dragged part. */
  get lit(): ReadonlySet<number> {
    const found = this.found;
    if (!found || found.reached) return new Set();
    if (!found.contact && !found.limits.length) return this.part === "hand" ? this.arm(this.side) : new Set<number>();
    const hinges = new Set(found.limits.map((name) => this.body.hinges.indexOf(name)));
    const limited = this.body.segments.flatMap((segment, k) =>
      segment.hinges.some(({ hinge }) => hinges.has(hinge)) ? [k] : [],
    );
    return new Set([...limited, ...(found.contact ?? []).map((name) => this.body.names.indexOf(name))]);
  }

  drag(drag: Drag): void {
    this.side = drag.side;
    this.part = drag.part;
    this.target = drag.target;
    this.next = drag;
    if (!this.busy) void this.ask();
  }

  drop(): void {
    this.next = null;
  }

  /** Return to the planned posture. */
  forget(): void {
    this.cancelled += 1;
    this.next = null;
    if (!this.posture) return;
    this.posture = this.found = null;
    this.changed(null);
  }

  /** Description of what stops the part. */
  words(found: Reached | null): string {
    if (!found) return "";
    if (found.reached && this.part !== "hand") return FREE[this.part];
    if (found.reached) {
      const { x, y, z } = findSector(this.body, this.side, this.target);
      return `within reach: ${x} ${y} ${z}`;
    }
    const far = `${(100 * found.residual).toFixed(1)} cm short`;
    if (found.contact) return `${found.contact.map(plain).join(" touches ")}: ${far}`;
    if (found.limits.length) return `at its limit: ${found.limits.map(plain).join(", ")}; ${far}`;
    return this.part === "hand" ? `the arm is straight: ${far}` : far;
  }

  private arm(side: Side): ReadonlySet<number> {
    const own = this.body.names.flatMap((name, k) => (name.startsWith(`${side[0]}_`) ? [k] : []));
    return new Set(own);
  }

  private async ask(): Promise<void> {
    this.busy = true;
    while (this.next) {
      const drag = this.next;
      this.next = null;
      const posture = this.posture ?? this.startPosture();
      const asked = performance.now();
      const cancelled = this.cancelled;
      const answer = await this.wire.ask("reach", { part: drag.part, side: drag.side, target: drag.target, posture });
      const found = answer?.told === "reach" && readReached(answer, this.body.hinges.length);
      if (!found || cancelled !== this.cancelled) continue;
      this.found = found;
      this.posture = this.found.angles;
      this.changed(this.found, drag.asked);
      const early = asked + PERIOD - performance.now();
      if (early > 0) await new Promise((again) => setTimeout(again, early));
    }
    this.busy = false;
  }
}
