"""Drawing of a face from action units (thesis chapters 3 to 5).

The head is drawn once into textures of a G-buffer; wrinkles, light and skin are screen passes over them, so their cost
depends only on the number of pixels.
"""

from collections.abc import Mapping
from contextlib import ExitStack, nullcontext
from functools import cache, lru_cache
from types import TracebackType

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.face.assets.hair import Locks, grow_locks
from kinesic.face.assets.hair_styles import HAIR_STYLES
from kinesic.face.assets.mesh import Mesh, load_head
from kinesic.face.assets.paint import COMPLEXIONS
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT_CAMERA, STUDIO_LIGHTS, Camera, Lights
from kinesic.face.render.pipeline import DrawnHead, Pipeline
from kinesic.face.render.presets import NORMAL_PRESET, Preset
from kinesic.face.render.pupils import compute_light_on_eyes, compute_settled_diameter
from kinesic.face.render.shape import HeadShape

MAX_PICTURE_SIDE = 4096  # [pixels] largest width or height of a picture
MAX_WRINKLE_GAIN = 4.0  # largest factor on the height of wrinkles
CHART_VARIANT: Variant = "female"  # head whose texture chart all variants use; their vertices correspond


class Portrait:
    """Reusable renderer of a head.

    Use it as a context manager, which frees its resources:

        with Portrait("male") as portrait:
            pixels = portrait.draw({"12": 0.8, "6": 0.6}, Camera(yaw_deg=30))
    """

    def __init__(
        self,
        variant: Variant = "female",
        *,
        preset: Preset = NORMAL_PRESET,
        size: tuple[int, int] = (512, 512),
        lights: Lights = STUDIO_LIGHTS,
        context: GlContext | None = None,
    ) -> None:
        """Load the head, compile the shaders and paint the textures.

        Args:
            variant: variant of the head.
            preset: quality preset.
            size: (width, height) of pictures [pixels].
            lights: lights attached to the camera.
            context: context of OpenGL 3.3 or later, which stays open; None opens one without a window.

        Raises:
            DisplayError: nothing can be drawn here, no such variant, or a size out of range.
        """
        if not all(1 <= side * preset.samples <= MAX_PICTURE_SIDE for side in size):
            limit = MAX_PICTURE_SIDE // preset.samples
            raise DisplayError(f"a picture of {size[0]} x {size[1]} pixels; use 1 to {limit} per side")
        self.mesh = _load_mesh(variant, preset.subdivided)
        self.preset, self.size, self.lights = preset, size, lights
        with ExitStack() as opened:
            own_context = opened.enter_context(open_offscreen_context()) if context is None else context
            head = DrawnHead(
                HeadShape(self.mesh),
                _load_mesh(CHART_VARIANT, preset.subdivided),
                COMPLEXIONS[variant],
                _grow_locks(variant) if preset.hair else None,
            )
            self.pipeline = Pipeline(own_context, head, preset=preset, size=size, lights=lights)
            self._current = (
                own_context if context is None else nullcontext()
            )  # several portraits may have their own contexts
            self._opened = opened.pop_all()

    def draw(
        self,
        units: Mapping[str, float],
        camera: Camera = FRONT_CAMERA,
        *,
        gain: float = 1.0,
        pupil: float | None = None,
    ) -> Picture:
        """Draw a face with action units.

        Args:
            units: action unit -> 0..1, as in `Command.face`.
            camera: camera of the picture.
            gain: gain of the wrinkles; 0 is none, 1 as drawn in the maps.
            pupil: pupil diameter [m], as from `Pupils`; None: the settled diameter in this light.

        Raises:
            DisplayError: an unknown action unit, an intensity outside 0..1, or a gain outside 0..4.
        """
        if not 0.0 <= gain <= MAX_WRINKLE_GAIN:
            raise DisplayError(f"wrinkles {gain:g} times as deep; use 0 to {MAX_WRINKLE_GAIN:g}")
        wide = compute_settled_diameter(compute_light_on_eyes(self.lights, {}, camera)) if pupil is None else pupil
        with self._current:
            self.pipeline.widen_pupils(wide)
            return self.pipeline.draw(units, camera, gain)

    def light(self, lights: Lights) -> None:
        """Replace the lamps and ambient light for the next pictures."""
        self.lights = lights
        self.pipeline.light(lights)

    def close(self) -> None:
        """Free the portrait's OpenGL resources.

        A given context keeps the textures until it is released itself.
        """
        self._opened.close()

    def __enter__(self) -> "Portrait":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@cache
def _grow_locks(variant: Variant) -> Locks:
    return grow_locks(load_head(variant), HAIR_STYLES[variant])


@lru_cache(maxsize=4)
def _load_mesh(variant: Variant, subdivided: bool) -> Mesh:
    mesh = load_head(variant)
    return mesh.subdivided() if subdivided else mesh
