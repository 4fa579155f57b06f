// Drawn state of the robot, and comparison of two such states.

export interface Shown {
  angles: readonly number[];
  ghost: readonly number[] | undefined;
  lit: ReadonlySet<number>;
  /** Tracking error per joint, 1: very large; red starts at 0.5. */
  strain?: readonly number[];
  /** [ms] time of the pointer event that requested it, if any. */
  asked?: number;
}

const EQUAL_ANGLES = 0.002; // [rad] invisible difference, one tick of a servo's encoder
const NEAR_STRAIN = 0.02;

const alike = (a: readonly number[] | undefined, b: readonly number[] | undefined, near: number): boolean =>
  a === b ||
  (a !== undefined &&
    b !== undefined &&
    a.length === b.length &&
    a.every((value, k) => Math.abs(value - b[k]!) <= near));

/** Whether two states look the same. */
export const same = (a: Shown, b: Shown): boolean =>
  alike(a.angles, b.angles, EQUAL_ANGLES) &&
  alike(a.ghost, b.ghost, EQUAL_ANGLES) &&
  alike(a.strain, b.strain, NEAR_STRAIN) &&
  alike([...a.lit], [...b.lit], 0);
