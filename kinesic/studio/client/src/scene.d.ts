// Scene renderer of the report's player and the studio: kinesic/report/templates/scene.js.
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
    /** Canvas pixels per CSS pixel; default: those of the screen. */
    scale?: number;
    /** Whether to draw shadows; default: yes. */
    full?: boolean;
  }
  type Triple = readonly [number, number, number];
  /** Part of the body with one colour. */
  export interface Shape {
    segment: number;
    hinges: readonly number[];
    colour: string;
    /** Six numbers per corner: position and normal in the segment's frame. */
    mesh: ArrayLike<number>;
    /** Three corner indices per triangle; default: all corners in order. */
    corners?: ArrayLike<number>;
  }
  export interface Scene {
    draw(picture: Picture): number[][];
    /** Frames (4 x 4, column-major) of all segments in the scene. */
    frames(angles: readonly number[]): Float32Array[];
    /** Camera position, and matrix from scene to canvas for an aspect ratio; default: that of the canvas. */
    camera(look: Look, shape?: { width: number; height: number }): { eye: Triple; view: Float32Array };
    /** Transformation from world to scene [m]. */
    up: Triple;
    /** Drawn shapes of the body; null for a robot with skin. */
    shapes: readonly Shape[] | null;
    /** Colour of a shape, components 0..1. */
    paint(shape: Shape, how: { duty?: readonly number[]; lit?: ReadonlySet<number> | undefined }): Triple;
  }
  export function sceneOf(canvas: HTMLCanvasElement, data: unknown, smooth?: boolean): Scene | null;
  /** Picture of the face on a screen, for a robot that shows nothing else on it. */
  export function plainFace(): { paper: HTMLCanvasElement };
}
