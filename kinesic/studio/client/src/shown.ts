// What the stage shows of the robot, and when two such pictures look the same.

export interface Shown {
  angles: readonly number[];
  ghost: readonly number[] | undefined;
  lit: ReadonlySet<number>;
  /** How far each hinge is from its plan, 1: very far; it is red from a half on. */
  strain?: readonly number[];
  /** [ms] when the pointer asked for it, where it did. */
  asked?: number;
}

const NEAR = 0.002; // [rad] that nobody sees, a tick of a servo's encoder: a robot that rests is still
const NEAR_STRAIN = 0.02;

const alike = (a: readonly number[] | undefined, b: readonly number[] | undefined, near: number): boolean =>
  a === b ||
  (a !== undefined &&
    b !== undefined &&
    a.length === b.length &&
    a.every((value, k) => Math.abs(value - b[k]!) <= near));

/** Whether two pictures of the robot look the same. */
export const same = (a: Shown, b: Shown): boolean =>
  alike(a.angles, b.angles, NEAR) &&
  alike(a.ghost, b.ghost, NEAR) &&
  alike(a.strain, b.strain, NEAR_STRAIN) &&
  alike([...a.lit], [...b.lit], 0);
