"""Says how much is drawn: from a draft for slow machines to everything."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.body.config import suggestion
from kinesic.face.display import DisplayError

Estimator = Literal["angular", "crytek", "obscurance", "horizon"]
Pattern = Literal["random", "regular", "jittered", "halton", "hammersley"]


@dataclass(frozen=True)
class Occlusion:
    """Ambient occlusion (thesis chapter 3)."""

    size: int = 11  # samples across, k: k x k of them if exact, else 2 k
    exact: bool = False  # else separable
    estimator: Estimator = "angular"
    pattern: Pattern = "hammersley"  # in which directions turn from pixel to pixel
    radius: float = 0.024  # [m] within which surfaces occlude
    strength: float = 1.7


@dataclass(frozen=True)
class Scattering:
    """Light that spreads under the skin (thesis 5.1 and 5.2)."""

    width: float = 0.0035  # [m] that red light spreads
    threshold: float = 0.93  # of openness: pixels more open than this and even are left as they are; 1 filters all
    steps: int = 3  # samples on each side


@dataclass(frozen=True)
class Shadow:
    """The soft shadow of the key light (thesis 12.1)."""

    lamp: float = 0.15  # [m] across: the wider, the softer
    away: float = 1.2  # [m] from the middle of the head to the lamp
    blockers: int = 4  # samples along a side where what is in the way is looked for
    taps: int = 6  # samples along a side of what is compared
    coloured: bool = False  # what light shines through tints it
    reach: float = 0.22  # [m] that it covers round the middle of the head, across
    deep: float = 0.35  # [m] and along the light
    side: int = 512  # pixels of its map
    sharpest: float = 0.004  # [m] across what is compared at least: the map has pixels


@dataclass(frozen=True)
class Focus:
    """Depth of field (thesis 12.1)."""

    circle: float = 0.03  # radius of confusion at its widest, as a share of the picture's height
    within: float = 0.03  # [m] from the nearer eye that is sharp, too
    taps: int = 24


@dataclass(frozen=True)
class Preset:
    """What a picture is drawn with; each part can be switched with `dataclasses.replace`."""

    name: str
    subdivided: bool = False  # four times the faces
    wrinkles: bool = True
    hair: bool = True  # in locks; else it is painted on the scalp alone
    occlusion: Occlusion | None = None
    scattering: Scattering | None = None  # steered by occlusion, if there is any
    shadow: Shadow | None = None
    focus: Focus | None = None
    eyeshade: bool = False  # worn by the head, translucent
    coarse: int = 2  # pixels along a side of one that occlusion and shadow are found for
    smooth: bool = True  # edges
    samples: int = 1  # pixels drawn along each side of a pixel shown


PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        preset.name: preset
        for preset in (
            Preset("draft", wrinkles=False, smooth=False),
            Preset("normal", shadow=Shadow(), occlusion=Occlusion(), scattering=Scattering()),
            Preset(
                "full",
                subdivided=True,
                occlusion=Occlusion(size=21),
                scattering=Scattering(threshold=1.0, steps=5),
                shadow=Shadow(blockers=6, taps=8, coloured=True),
                focus=Focus(),
                samples=2,
            ),
        )
    }
)
DRAFT, NORMAL, FULL = PRESETS.values()


def quality_preset(name: str) -> Preset:
    """Finds a preset by its name.

    Raises:
        DisplayError: there is none.
    """
    if name not in PRESETS:
        raise DisplayError(f"no preset {name}{suggestion(name, list(PRESETS))}; there are {', '.join(PRESETS)}")
    return PRESETS[name]
