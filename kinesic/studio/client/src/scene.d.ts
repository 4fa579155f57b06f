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
    /** Whether every triangle is drawn, and shadows; they are where it is left out. */
    full?: boolean;
  }
  export interface Scene {
    draw(picture: Picture): number[][];
    /** Frames (4 x 4, columns first) of all segments, as they stand in the picture. */
    frames(angles: readonly number[]): Float32Array[];
    /** Where the camera is, and the matrix from the picture to the canvas. */
    camera(look: Look): { eye: number[]; view: Float32Array };
    /** From the world to the picture [m]. */
    up: readonly number[];
  }
  export function sceneOf(canvas: HTMLCanvasElement, data: unknown, smooth?: boolean): Scene | null;
}
