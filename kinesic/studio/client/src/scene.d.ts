// What the report's player and the studio draw with: kinesic/report/templates/scene.js.
declare module "kinesic:scene" {
  export interface Look {
    turn: number;
    rise: number;
    zoom: number;
  }
  export interface Posture {
    angles: readonly number[];
    duty?: readonly number[];
  }
  export interface Picture {
    look: Look;
    twin: Posture;
    ghost: readonly number[] | undefined;
    beside: boolean;
    ink: readonly number[];
    lit?: ReadonlySet<number>;
    /** Pixels of the canvas for each CSS pixel; the screen's where it is left out. */
    scale?: number;
    /** Whether shadows are drawn; they are where it is left out. */
    full?: boolean;
  }
  type Triple = readonly [number, number, number];
  /** A part of the body that has one colour. */
  export interface Shape {
    segment: number;
    hinges: readonly number[];
    colour: string;
    /** Six numbers for each corner: its place and its normal, in the frame of its segment. */
    mesh: ArrayLike<number>;
    /** Corners of its triangles, three for each; all of the mesh in order where they are left out. */
    corners?: ArrayLike<number>;
  }
  export interface Scene {
    draw(picture: Picture): number[][];
    /** Frames (4 x 4, columns first) of all segments, as they stand in the picture. */
    frames(angles: readonly number[]): Float32Array[];
    /** Where the camera is, and the matrix from the picture to a canvas of a shape, its own where that is left out. */
    camera(look: Look, shape?: { width: number; height: number }): { eye: Triple; view: Float32Array };
    /** From the world to the picture [m]. */
    up: Triple;
    /** What is drawn of the body; null where it has a skin. */
    shapes: readonly Shape[] | null;
    /** The colour of a shape, each share 0..1. */
    paint(shape: Shape, how: { duty?: readonly number[]; lit?: ReadonlySet<number> | undefined }): Triple;
  }
  export function sceneOf(canvas: HTMLCanvasElement, data: unknown, smooth?: boolean): Scene | null;
  /** The face on a screen, of a robot that shows nothing else on it. */
  export function plainFace(): { paper: HTMLCanvasElement };
}
