"""What of a preset is drawn otherwise: the comparisons of the thesis, each by a word."""

from dataclasses import dataclass, replace
from typing import Literal, TypeVar

from kinesic.face.display import DisplayError
from kinesic.face.render.camera import FAREST, NEAR
from kinesic.face.render.presets import Estimator, Falloff, Focus, Occlusion, Pattern, Preset, Scattering, Shadow

Marching = Literal["none", "exact", "separable", "one-axis"]
Spreading = Literal["none", "adaptive", "levels", "everywhere"]
Shading = Literal["none", "plain", "coloured"]

LEVELS, LEVEL_STEPS = 3, 5  # of scattering in levels, and samples on each side in the last of them
HOW = "write eyes, a distance such as 0.8, or two such as 0.75:0.85"
Chosen = TypeVar("Chosen")


@dataclass(frozen=True)
class Effects:
    """What differs from a preset; None is as the preset has it."""

    occlusion: Marching | None = None
    size: int | None = None  # samples across
    estimator: Estimator | None = None
    falloff: Falloff | None = None
    pattern: Pattern | None = None
    tile: int | None = None  # pixels along a side of the pattern
    scattering: Spreading | None = None
    shadow: Shading | None = None
    focus: str | None = None  # none, eyes, [m] from the camera, or two of them with a colon between
    eyeshade: bool = False  # worn by the head, translucent

    def applied(self, preset: Preset) -> Preset:
        """Gives a preset with what differs.

        Raises:
            DisplayError: a number is out of its range, or no focus is written so.
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
        if self.occlusion == "none" or (usual is None and all(each is None for each in details)):
            return None
        own = usual or Occlusion()
        return replace(
            own,
            exact=own.exact if self.occlusion is None else self.occlusion == "exact",
            axes=own.axes if self.occlusion is None else 1 if self.occlusion == "one-axis" else 2,
            size=_chosen(self.size, own.size),
            estimator=_chosen(self.estimator, own.estimator),
            falloff=_chosen(self.falloff, own.falloff),
            pattern=_chosen(self.pattern, own.pattern),
            tile=_chosen(self.tile, own.tile),
        )

    def _scattering(self, usual: Scattering | None) -> Scattering | None:
        own = usual or Scattering()
        match self.scattering:
            case None:
                return usual
            case "none":
                return None
            case "adaptive":
                return replace(own, threshold=Scattering().threshold, levels=1)
            case "levels":
                return replace(own, threshold=1.0, steps=max(own.steps, LEVEL_STEPS), levels=LEVELS)
            case "everywhere":
                return replace(own, threshold=1.0, levels=1)

    def _shadow(self, usual: Shadow | None) -> Shadow | None:
        if self.shadow is None:
            return usual
        return None if self.shadow == "none" else replace(usual or Shadow(), coloured=self.shadow == "coloured")


def read_focus(text: str) -> Focus | None:
    """Reads what is sharp: `none` (everything), `eyes`, a distance from the camera [m], or a range of distances.

    Raises:
        DisplayError: it is none of these, or nothing can be seen so far away.
    """
    if text in ("none", "eyes"):
        return Focus() if text == "eyes" else None
    try:
        ends = sorted(float(each) for each in text.split(":"))
    except ValueError:
        raise DisplayError(f"focus {text!r}: {HOW}") from None
    if len(ends) > 2:
        raise DisplayError(f"focus {text!r}: {HOW}")
    for each in ends:
        if not NEAR <= each <= FAREST:
            raise DisplayError(f"focus at {each:g} m; it may be {NEAR:g} to {FAREST:g} m from the camera")
    if len(ends) == 1:
        return Focus(plane=ends[0])
    return Focus(plane=sum(ends) / 2, within=(ends[1] - ends[0]) / 2)


def _chosen(asked: Chosen | None, usual: Chosen) -> Chosen:
    return usual if asked is None else asked
