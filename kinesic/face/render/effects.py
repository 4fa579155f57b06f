"""Changes of rendering presets for the comparisons of the thesis."""

from dataclasses import dataclass, replace
from typing import Literal, TypeVar

from kinesic.face.display import DisplayError
from kinesic.face.render.camera import MAX_CAMERA_DISTANCE, NEAR_PLANE
from kinesic.face.render.presets import Estimator, Falloff, Focus, Occlusion, Pattern, Preset, Scattering, Shadow

Marching = Literal["none", "exact", "separable", "one-axis"]
Spreading = Literal["none", "adaptive", "levels", "everywhere"]
Shading = Literal["none", "plain", "coloured"]

SCATTERING_LEVELS = 3  # number of levels of detail of subsurface scattering
LEVEL_STEPS = 5  # smallest number of scattering samples on each side of a pixel in the most detailed level
FOCUS_REMEDY = "write eyes, a distance such as 0.8, or two such as 0.75:0.85"
ValueType = TypeVar("ValueType")


@dataclass(frozen=True)
class Effects:
    """Differences of rendering effects from a quality preset.

    None keeps the preset's value.
    """

    occlusion: Marching | None = None
    size: int | None = None  # number of samples across the occlusion kernel
    estimator: Estimator | None = None
    falloff: Falloff | None = None
    pattern: Pattern | None = None
    tile: int | None = None  # [pixels] side of the pattern
    scattering: Spreading | None = None
    shadow: Shading | None = None
    focus: str | None = None  # none, eyes, a distance [m], or a range such as 0.75:0.85
    eyeshade: bool = False  # whether the head wears an eyeshade

    def apply_to(self, preset: Preset) -> Preset:
        """Return a quality preset with these rendering effects.

        Raises:
            DisplayError: a number is out of range, or the focus is invalid.
        """
        return replace(
            preset,
            occlusion=self._occlusion(preset.occlusion),
            scattering=self._scattering(preset.scattering),
            shadow=self._shadow(preset.shadow),
            focus=preset.focus if self.focus is None else read_focus(self.focus),
            eyeshade=preset.eyeshade or self.eyeshade,
        )

    def _occlusion(self, usual: Occlusion | None) -> Occlusion | None:
        details = (self.occlusion, self.size, self.estimator, self.falloff, self.pattern, self.tile)
        if self.occlusion == "none" or (usual is None and all(detail is None for detail in details)):
            return None
        base = usual or Occlusion()
        return replace(
            base,
            exact=base.exact if self.occlusion is None else self.occlusion == "exact",
            axes=base.axes if self.occlusion is None else 1 if self.occlusion == "one-axis" else 2,
            size=_choose(self.size, base.size),
            estimator=_choose(self.estimator, base.estimator),
            falloff=_choose(self.falloff, base.falloff),
            pattern=_choose(self.pattern, base.pattern),
            tile=_choose(self.tile, base.tile),
        )

    def _scattering(self, usual: Scattering | None) -> Scattering | None:
        base = usual or Scattering()
        match self.scattering:
            case None:
                return usual
            case "none":
                return None
            case "adaptive":
                return replace(base, threshold=Scattering().threshold, levels=1)
            case "levels":
                return replace(base, threshold=1.0, steps=max(base.steps, LEVEL_STEPS), levels=SCATTERING_LEVELS)
            case "everywhere":
                return replace(base, threshold=1.0, levels=1)

    def _shadow(self, usual: Shadow | None) -> Shadow | None:
        if self.shadow is None:
            return usual
        return None if self.shadow == "none" else replace(usual or Shadow(), coloured=self.shadow == "coloured")


def read_focus(text: str) -> Focus | None:
    """Read a focus: `none`, `eyes`, a distance or a distance range.

    `none` keeps everything sharp. Distances are from the camera [m].

    Raises:
        DisplayError: any other text, or a distance out of range.
    """
    if text in ("none", "eyes"):
        return Focus() if text == "eyes" else None
    try:
        ends = sorted(float(distance) for distance in text.split(":"))
    except ValueError:
        raise DisplayError(f"focus {text!r}: {FOCUS_REMEDY}") from None
    if len(ends) > 2:
        raise DisplayError(f"focus {text!r}: {FOCUS_REMEDY}")
    for distance in ends:
        if not NEAR_PLANE <= distance <= MAX_CAMERA_DISTANCE:
            raise DisplayError(
                f"focus at {distance:g} m; use {NEAR_PLANE:g} to {MAX_CAMERA_DISTANCE:g} m from the camera"
            )
    if len(ends) == 1:
        return Focus(plane=ends[0])
    return Focus(plane=sum(ends) / 2, within=(ends[1] - ends[0]) / 2)


def _choose(requested: ValueType | None, usual: ValueType) -> ValueType:
    return usual if requested is None else requested
