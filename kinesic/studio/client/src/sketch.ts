// The robot as it is drawn while it moves where there is no graphics card: by the processor, from fewer triangles.
import { type Picture, plainFace, type Scene, type Shape } from "kinesic:scene";
import { cellOf, coarsen } from "./coarse.ts";
import { floorOf } from "./floor.ts";
import { differenceOf, Raster, type Texture } from "./raster.ts";
import { lightCorners, placeCorners, type Seen, type Solid, shareCorners, solidOf } from "./solid.ts";
import type { Body } from "./types.ts";
import type { Vector } from "./vectors.ts";

const GHOST = 0.38; // how opaque the ghost is
const FACE = { width: 96, height: 72 }; // [pixels] of the face on a screen

interface Size {
  width: number;
  height: number;
}

/** The face on the robot's screen, as small as it is seen. */
function readFace(): Texture {
  const pen = new OffscreenCanvas(FACE.width, FACE.height).getContext("2d")!;
  pen.imageSmoothingQuality = "high";
  pen.drawImage(plainFace().paper, 0, 0, FACE.width, FACE.height);
  return { ...FACE, pixels: new Uint32Array(pen.getImageData(0, 0, FACE.width, FACE.height).data.buffer) };
}

export class Sketch {
  private readonly pen: CanvasRenderingContext2D;
  private readonly raster = new Raster();
  private readonly face: Texture | undefined;
  private readonly solids: Solid[];
  private ground: Texture = { width: 0, height: 0, pixels: new Uint32Array(0) };
  private grounded = ""; // what the ground was made for
  private shown = new ImageData(1, 1);
  private shownPixels = new Uint32Array(this.shown.data.buffer);
  private over = new Uint32Array(0); // the ghost alone

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly scene: Scene,
    shapes: readonly Shape[],
    { screen }: Body,
  ) {
    this.pen = canvas.getContext("2d", { willReadFrequently: true })!;
    this.solids = shapes.map((shape) =>
      solidOf(coarsen(shape.mesh, shape.corners, cellOf(shape.mesh)), shape.segment, shape),
    );
    if (!screen) return;
    this.face = readFace();
    const { picture, segment } = screen;
    const mesh = { places: new Float32Array(picture.places), normals: new Float32Array(picture.normals) };
    this.solids.push(
      solidOf({ ...mesh, triangles: new Uint32Array(picture.triangles) }, segment, null, picture.shares),
    );
  }

  /**
   * Draws a picture, and shows it.
   * @param seen from where, and where the segments of its twin are
   * @param size of the stage [CSS pixels]
   * @param scale pixels for each of them
   */
  draw({ twin, ghost, ink, lit }: Picture, seen: Seen, size: Size, scale: number): void {
    const { raster, scene } = this;
    const width = Math.max(1, Math.round(size.width * scale));
    const height = Math.max(1, Math.round(size.height * scale));
    this.prepareGround(seen.view, ink, width, height);
    raster.begin(this.ground);
    this.drawBody(seen, (shape) => scene.paint(shape, { ...twin, lit }));
    if (ghost) {
      if (this.over.length !== raster.pixels.length) this.over = new Uint32Array(raster.pixels.length);
      else this.over.fill(0);
      this.drawBody({ ...seen, frames: scene.frames(ghost) }, (shape) => scene.paint(shape, {}), this.over);
      raster.lay(this.over, GHOST);
    }
    this.show(width, height);
  }

  hide(): void {
    this.canvas.hidden = true;
  }

  /** Shows what is drawn: only where it differs from what is shown, as the browser paints all that it is given. */
  private show(width: number, height: number): void {
    const { canvas, raster } = this;
    if (this.shown.width !== width || this.shown.height !== height) {
      canvas.width = width;
      canvas.height = height;
      this.shown = new ImageData(width, height);
      this.shownPixels = new Uint32Array(this.shown.data.buffer);
    }
    canvas.hidden = false;
    const box = differenceOf(raster.pixels, this.shownPixels, width);
    if (!box) return;
    this.shownPixels.set(raster.pixels);
    this.pen.putImageData(this.shown, 0, 0, box.x, box.y, box.width, box.height);
  }

  private prepareGround(view: Float32Array, ink: readonly number[], width: number, height: number): void {
    const about = [...view, ...ink, width, height].join();
    if (about === this.grounded) return;
    this.grounded = about;
    this.ground = floorOf(view, ink, width, height);
  }

  private drawBody(seen: Seen, paint: (shape: Shape) => Vector, into?: Uint32Array): void {
    for (const solid of this.solids) {
      if (!solid.shape && into) continue; // a ghost shows no face
      placeCorners(solid, seen, this.raster);
      if (solid.shape) lightCorners(solid, seen, paint(solid.shape));
      else shareCorners(solid, seen);
      const { corners, triangles } = solid;
      const texture = solid.shape ? undefined : this.face;
      for (let k = 0; k < triangles.length; k += 3)
        this.raster.fill(corners, triangles[k]!, triangles[k + 1]!, triangles[k + 2]!, into, texture);
    }
  }
}
