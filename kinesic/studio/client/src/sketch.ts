// Robot drawn by the CPU from fewer triangles, used during motion without a graphics card.
import { type Picture, plainFace, type Scene, type Shape } from "kinesic:scene";
import { cellSize, coarsen } from "./coarse.ts";
import { drawFloor } from "./floor.ts";
import { findDifference, Raster, type Texture } from "./raster.ts";
import { lightCorners, makeSolid, placeCorners, type Seen, type Solid, shareCorners } from "./solid.ts";
import type { Body } from "./types.ts";
import type { Vector } from "./vectors.ts";

const GHOST_OPACITY = 0.38; // opacity of the ghost
const FACE_SIZE = { width: 96, height: 72 }; // [pixels] size of the face on a screen

interface Size {
  width: number;
  height: number;
}

/** Picture of the face on the robot's screen, at its small visible size. */
function readFace(): Texture {
  const pen = new OffscreenCanvas(FACE_SIZE.width, FACE_SIZE.height).getContext("2d")!;
  pen.imageSmoothingQuality = "high";
  pen.drawImage(plainFace().paper, 0, 0, FACE_SIZE.width, FACE_SIZE.height);
  return {
    ...FACE_SIZE,
    pixels: new Uint32Array(pen.getImageData(0, 0, FACE_SIZE.width, FACE_SIZE.height).data.buffer),
  };
}

export class Sketch {
  private readonly pen: CanvasRenderingContext2D;
  private readonly raster = new Raster();
  private readonly face: Texture | undefined;
  private readonly solids: Solid[];
  private ground: Texture = { width: 0, height: 0, pixels: new Uint32Array(0) };
  private grounded = ""; // input of the drawn background
  private shown = new ImageData(1, 1);
  private shownPixels = new Uint32Array(this.shown.data.buffer);
  private over = new Uint32Array(0); // pixels of the ghost

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly scene: Scene,
    shapes: readonly Shape[],
    { screen }: Body,
  ) {
    this.pen = canvas.getContext("2d", { willReadFrequently: true })!;
    this.solids = shapes.map((shape) =>
      makeSolid(coarsen(shape.mesh, shape.corners, cellSize(shape.mesh)), shape.segment, shape),
    );
    if (!screen) return;
    this.face = readFace();
    const { picture, segment } = screen;
    const mesh = { places: new Float32Array(picture.places), normals: new Float32Array(picture.normals) };
    this.solids.push(
      makeSolid({ ...mesh, triangles: new Uint32Array(picture.triangles) }, segment, null, picture.shares),
    );
  }

  /**
   * Draw and show a picture.
   * @param seen viewpoint, and segment frames of the twin
   * @param size size of the stage [CSS pixels]
   * @param scale canvas pixels per CSS pixel
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
      raster.lay(this.over, GHOST_OPACITY);
    }
    this.show(width, height);
  }

  hide(): void {
    this.canvas.hidden = true;
  }

  /** Show the changed region only, because the browser repaints everything that it gets. */
  private show(width: number, height: number): void {
    const { canvas, raster } = this;
    if (this.shown.width !== width || this.shown.height !== height) {
      canvas.width = width;
      canvas.height = height;
      this.shown = new ImageData(width, height);
      this.shownPixels = new Uint32Array(this.shown.data.buffer);
    }
    canvas.hidden = false;
    const box = findDifference(raster.pixels, this.shownPixels, width);
    if (!box) return;
    this.shownPixels.set(raster.pixels);
    this.pen.putImageData(this.shown, 0, 0, box.x, box.y, box.width, box.height);
  }

  private prepareGround(view: Float32Array, ink: readonly number[], width: number, height: number): void {
    const about = [...view, ...ink, width, height].join();
    if (about === this.grounded) return;
    this.grounded = about;
    this.ground = drawFloor(view, ink, width, height);
  }

  private drawBody(seen: Seen, paint: (shape: Shape) => Vector, into?: Uint32Array): void {
    for (const solid of this.solids) {
      if (!solid.shape && into) continue; // a ghost has no face
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
