"""Draws a face: action units in, a picture out, through a deferred pipeline (thesis chapters 3 to 5).

The head is drawn once, into textures of what each pixel shows; wrinkles, light and skin are screen-wide passes over
them, so that their cost depends on the number of pixels alone.
"""

from collections.abc import Mapping
from contextlib import ExitStack, nullcontext
from functools import cache, lru_cache
from types import TracebackType

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.face.assets.hair import STYLES, Locks, grow
from kinesic.face.assets.mesh import Mesh, load_head
from kinesic.face.assets.paint import COMPLEXIONS
from kinesic.face.display import DisplayError, offscreen
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT, LIGHTS, Camera, Lights
from kinesic.face.render.pipeline import DrawnHead, Pipeline
from kinesic.face.render.presets import NORMAL, Preset
from kinesic.face.render.pupils import light_on_eyes, settled_diameter
from kinesic.face.render.shape import HeadShape

LARGEST_SIDE = 4096  # pixels along a side
LOUDEST = 4.0  # gain of the wrinkles
CHART: Variant = "female"  # whose chart the painting and the wrinkles of all are drawn in; the vertices correspond


class Portrait:
    """A head ready to be drawn, again and again; a context manager that frees what it holds.

    with Portrait("male") as portrait:
        pixels = portrait.draw({"12": 0.8, "6": 0.6}, Camera(yaw_deg=30))
    """

    def __init__(
        self,
        variant: Variant = "female",
        *,
        preset: Preset = NORMAL,
        size: tuple[int, int] = (512, 512),
        lights: Lights = LIGHTS,
        context: GlContext | None = None,
    ) -> None:
        """Loads the head, compiles the shaders and paints the textures.

        Args:
            variant: of the head.
            preset: how much is drawn.
            size: (width, height) of pictures [pixels].
            lights: that stand with the camera.
            context: to draw in, of OpenGL 3.3 or later, which stays open; its own without a window if None.

        Raises:
            DisplayError: nothing can be drawn here, no such variant, or no picture of this size.
        """
        if not all(1 <= side * preset.samples <= LARGEST_SIDE for side in size):
            limit = LARGEST_SIDE // preset.samples
            raise DisplayError(f"a picture of {size[0]} x {size[1]} pixels; each side may be 1 to {limit}")
        self.mesh = _mesh(variant, preset.subdivided)
        self.preset, self.size, self.lights = preset, size, lights
        with ExitStack() as opened:
            own = opened.enter_context(offscreen()) if context is None else context
            head = DrawnHead(
                HeadShape(self.mesh),
                _mesh(CHART, preset.subdivided),
                COMPLEXIONS[variant],
                _locks(variant) if preset.hair else None,
            )
            self.pipeline = Pipeline(own, head, preset=preset, size=size, lights=lights)
            self._current = own if context is None else nullcontext()  # another portrait may have its own
            self._opened = opened.pop_all()

    def draw(
        self,
        units: Mapping[str, float],
        camera: Camera = FRONT,
        *,
        gain: float = 1.0,
        pupil: float | None = None,
    ) -> Picture:
        """Draws a face that shows some action units.

        Args:
            units: action unit -> 0..1, as in `Command.face`.
            camera: where it is seen from.
            gain: of the wrinkles; 0 is none, 1 as they were drawn.
            pupil: [m] across, as `Pupils` has it; None: as it is after a while in this light.

        Raises:
            DisplayError: an unknown unit, an intensity outside 0..1, or a gain outside 0..4.
        """
        if not 0.0 <= gain <= LOUDEST:
            raise DisplayError(f"wrinkles {gain:g} times as deep; 0 to {LOUDEST:g} can be drawn")
        wide = settled_diameter(light_on_eyes(self.lights, {}, camera)) if pupil is None else pupil
        with self._current:
            self.pipeline.widen_pupils(wide)
            return self.pipeline.draw(units, camera, gain)

    def light(self, lights: Lights) -> None:
        """Lights what is drawn from now on otherwise."""
        self.lights = lights
        self.pipeline.light(lights)

    def close(self) -> None:
        """Frees what is the portrait's own; a given context keeps the textures until it is released itself."""
        self._opened.close()

    def __enter__(self) -> "Portrait":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@cache
def _locks(variant: Variant) -> Locks:
    return grow(load_head(variant), STYLES[variant])


@lru_cache(maxsize=4)
def _mesh(variant: Variant, subdivided: bool) -> Mesh:
    mesh = load_head(variant)
    return mesh.subdivided() if subdivided else mesh
