"""Says how much is drawn: from a draft for slow machines to everything."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.body.config import suggestion
from kinesic.face.display import DisplayError

Estimator = Literal["angular", "crytek", "obscurance", "horizon"]
Pattern = Literal["random", "regular", "jittered", "halton", "hammersley", "noise"]  # noise: never the same tile again
Falloff = Literal["wendland", "gaussian"]
Axes = Literal[1, 2]

TILES = range(2, 9)  # pixels along a side of a pattern that there may be
LARGEST_SIZE = 63  # samples across


@dataclass(frozen=True)
class Occlusion:
    """Ambient occlusion (thesis chapter 3)."""

    size: int = 11  # samples across, k: k x k of them if exact, else 2 k
    exact: bool = False  # else along a few axes
    axes: Axes = 2  # at right angles to each other: 2 is separable; 1 sees too little (Figure 3.9)
    estimator: Estimator = "angular"
    pattern: Pattern = "hammersley"  # in which directions turn from pixel to pixel
    tile: int = 4  # pixels along a side of it, and of the blur that takes it out (listing 11.1)
    falloff: Falloff = "wendland"  # of what is further away (3.3)
    radius: float = 0.024  # [m] within which surfaces occlude
    strength: float = 1.7

    def __post_init__(self) -> None:
        if self.tile not in TILES:
            raise DisplayError(f"a pattern of {self.tile} x {self.tile} pixels; there are {TILES[0]} to {TILES[-1]}")
        if not 2 <= self.size <= LARGEST_SIZE:
            raise DisplayError(f"occlusion with {self.size} samples across; there may be 2 to {LARGEST_SIZE}")

    @property
    def directions(self) -> int:
        """How many directions are marched along, each both ways."""
        return self.size if self.exact else self.axes


@dataclass(frozen=True)
class Scattering:
    """Light that spreads under the skin (thesis 5.1 and 5.2)."""

    width: float = 0.0035  # [m] that red light spreads
    threshold: float = 0.93  # of openness: pixels more open than this and even are left as they are; 1 filters all
    steps: int = 3  # samples on each side
    levels: int = 1  # of detail: the more occluded, the more of the samples are taken (Figure 5.2); at most `steps`
    deep: float = 0.6  # openness at which all of them are

    def __post_init__(self) -> None:
        if self.levels > 1 and not self.deep < self.threshold:
            raise DisplayError(
                f"all levels at openness {self.deep:g}; it must be below the threshold {self.threshold:g}"
            )
        if not 1 <= self.levels <= self.steps:
            raise DisplayError(
                f"light spreads in {self.levels} levels; with {self.steps} samples there are 1 to {self.steps}"
            )


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
    plane: float | None = None  # [m] of depth from the camera that is sharp; None: that of the nearer eye
    within: float = 0.03  # [m] before and behind it that is sharp, too
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
