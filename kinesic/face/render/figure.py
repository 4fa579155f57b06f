"""Drawing of a whole figure from joint angles and action units.

The pipeline is that of heads.
"""

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
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.render.camera import STUDIO_LIGHTS, Camera, Lights
from kinesic.face.render.pipeline import DrawnHead, Pipeline
from kinesic.face.render.portrait import MAX_PICTURE_SIDE
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET, Occlusion, Preset, Shadow
from kinesic.face.render.shape import FigureShape

STANDING_CAMERA = Camera(distance=4.2, field_deg=26.0, pivot=(0.05, 0.0, 0.83))  # camera that shows the whole figure
UPPER_BODY_CAMERA = Camera(distance=2.9, field_deg=23.0, pivot=(0.05, 0.0, 1.24))  # view from the hips up
# Shadow settings for a whole standing figure.
FIGURE_SHADOW = Shadow(lamp=0.3, away=4.0, reach=1.0, deep=1.2, side=1024, sharpest=0.012)
FILM_PRESET = replace(
    DRAFT_PRESET,
    name="filmed",
    subdivided=True,
    wrinkles=True,
    smooth=True,
    shadow=Shadow(blockers=3, taps=4),
    coarse=3,
)
OCCLUSION_RADIUS = 0.05  # [m] radius of ambient occlusion on figures


class FigurePortrait:
    """Reusable renderer of a whole figure.

    Use it as a context manager, which frees its resources:

        with FigurePortrait(Robot.load("human").skeleton) as portrait:
            pixels = portrait.draw(angles, {"12": 0.8})
    """

    def __init__(
        self,
        skeleton: Skeleton,
        *,
        preset: Preset = NORMAL_PRESET,
        size: tuple[int, int] = (512, 512),
        lights: Lights = STUDIO_LIGHTS,
        blending: Blending = "linear",
    ) -> None:
        """Load the figure, compile the shaders and paint the textures.

        Args:
            skeleton: skeleton that moves the figure.
            preset: quality preset.
            size: (width, height) of pictures [pixels].
            lights: lights attached to the camera.
            blending: skinning method.

        Raises:
            DisplayError: nothing can be drawn here, or the size is out of range.
        """
        if not all(1 <= side * preset.samples <= MAX_PICTURE_SIDE for side in size):
            limit = MAX_PICTURE_SIDE // preset.samples
            raise DisplayError(f"a picture of {size[0]} x {size[1]} pixels; use 1 to {limit} per side")
        figure = _load_figure(preset.subdivided)
        self.shape = FigureShape(figure, skeleton, blending=blending)
        with ExitStack() as opened:
            self._context = opened.enter_context(open_offscreen_context())
            drawn = DrawnHead(self.shape, figure.mesh, COMPLEXIONS["female"], figure.locks if preset.hair else None)
            self.pipeline = Pipeline(
                self._context, drawn, preset=scale_preset_to_figure(preset), size=size, lights=lights
            )
            self._opened = opened.pop_all()

    def draw(
        self, angles: Floats, units: Mapping[str, float], camera: Camera = UPPER_BODY_CAMERA, *, gain: float = 1.0
    ) -> Picture:
        """Draw the figure in a posture.

        Args:
            angles: (n,) [rad] in joint order.
            units: action unit -> 0..1, as in `Command.face`.
            camera: camera of the picture.
            gain: gain of the wrinkles.

        Raises:
            DisplayError: an unknown action unit, or an intensity outside 0..1.
        """
        self.shape.angles = angles
        with self._context:
            return self.pipeline.draw(units, camera, gain)

    def close(self) -> None:
        """Free the figure renderer's OpenGL resources."""
        self._opened.close()

    def __enter__(self) -> "FigurePortrait":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def scale_preset_to_figure(preset: Preset) -> Preset:
    """Return a face preset adapted to a whole figure.

    Occlusion and shadow have the lengths of a figure. Focus and eyeshade are off.
    """
    return replace(
        preset,
        focus=None,
        eyeshade=False,
        occlusion=preset.occlusion and _scale_occlusion(preset.occlusion),
        shadow=preset.shadow and replace(FIGURE_SHADOW, blockers=preset.shadow.blockers, taps=preset.shadow.taps),
    )


def _scale_occlusion(occlusion: Occlusion) -> Occlusion:
    return replace(occlusion, radius=OCCLUSION_RADIUS)


@lru_cache(maxsize=2)
def _load_figure(subdivided: bool) -> DressedPerson:
    figure = load_figure()
    return figure.subdivided() if subdivided else figure
