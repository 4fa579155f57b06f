"""Draws a whole figure: angles and action units in, a picture out, through the pipeline that draws heads."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache
from types import TracebackType

from kinesic.body.arrays import Floats, Picture
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import DressedPerson, load_figure
from kinesic.face.assets.paint import COMPLEXIONS
from kinesic.face.assets.skinning import Blending
from kinesic.face.display import DisplayError, offscreen
from kinesic.face.render.camera import LIGHTS, Camera, Lights
from kinesic.face.render.pipeline import DrawnHead, Pipeline
from kinesic.face.render.portrait import LARGEST_SIDE
from kinesic.face.render.presets import DRAFT, NORMAL, Occlusion, Preset, Shadow
from kinesic.face.render.shape import FigureShape

STANDING = Camera(distance=4.2, field_deg=26.0, pivot=(0.05, 0.0, 0.83))  # from head to foot
UPPER = Camera(distance=2.9, field_deg=23.0, pivot=(0.05, 0.0, 1.24))  # from the hips up, with room for both arms
SHADOW = Shadow(lamp=0.3, away=4.0, reach=1.0, deep=1.2, side=1024, sharpest=0.012)
FILMED = replace(DRAFT, name="filmed", wrinkles=True, smooth=True, shadow=Shadow(blockers=3, taps=4), coarse=3)
HOLLOW = 0.05  # [m] what darkens a hollow


class FigurePortrait:
    """A figure ready to be drawn, again and again; a context manager that frees what it holds.

    with FigurePortrait(Robot.load("human").skeleton) as portrait:
        pixels = portrait.draw(angles, {"12": 0.8})
    """

    def __init__(
        self,
        skeleton: Skeleton,
        *,
        preset: Preset = NORMAL,
        size: tuple[int, int] = (512, 512),
        lights: Lights = LIGHTS,
        blending: Blending = "linear",
    ) -> None:
        """Loads the figure, compiles the shaders and paints the textures.

        Args:
            skeleton: that moves it.
            preset: how much is drawn.
            size: (width, height) of pictures [pixels].
            lights: that stand with the camera.
            blending: how its skin follows.

        Raises:
            DisplayError: nothing can be drawn here, or no picture of this size.
        """
        if not all(1 <= side * preset.samples <= LARGEST_SIDE for side in size):
            limit = LARGEST_SIDE // preset.samples
            raise DisplayError(f"a picture of {size[0]} x {size[1]} pixels; each side may be 1 to {limit}")
        figure = _figure(preset.subdivided)
        self.shape = FigureShape(figure, skeleton, blending=blending)
        with ExitStack() as opened:
            self._context = opened.enter_context(offscreen())
            drawn = DrawnHead(self.shape, figure.mesh, COMPLEXIONS["female"])
            self.pipeline = Pipeline(self._context, drawn, preset=figure_preset(preset), size=size, lights=lights)
            self._opened = opened.pop_all()

    def draw(self, angles: Floats, units: Mapping[str, float], camera: Camera = UPPER, *, gain: float = 1.0) -> Picture:
        """Draws the figure in a posture.

        Args:
            angles: (n,) [rad] in joint order.
            units: action unit -> 0..1, as in `Command.face`.
            camera: where it is seen from.
            gain: of the wrinkles.

        Raises:
            DisplayError: an unknown unit, or an intensity outside 0..1.
        """
        self.shape.angles = angles
        with self._context:
            return self.pipeline.draw(units, camera, gain)

    def close(self) -> None:
        """Frees what is the portrait's own."""
        self._opened.close()

    def __enter__(self) -> "FigurePortrait":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def figure_preset(preset: Preset) -> Preset:
    """Widens what a preset does about a head to the size of a figure."""
    return replace(
        preset,
        focus=None,
        eyeshade=False,
        occlusion=preset.occlusion and _wide(preset.occlusion),
        shadow=preset.shadow and replace(SHADOW, blockers=preset.shadow.blockers, taps=preset.shadow.taps),
    )


def _wide(occlusion: Occlusion) -> Occlusion:
    return replace(occlusion, radius=HOLLOW)


@lru_cache(maxsize=2)
def _figure(subdivided: bool) -> DressedPerson:
    figure = load_figure()
    return figure.subdivided() if subdivided else figure
