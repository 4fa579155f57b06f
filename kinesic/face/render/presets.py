"""Quality presets, from a draft for slow machines to full quality."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.face.display import DisplayError

Estimator = Literal[
    "angular", "crytek", "obscurance", "horizon", "depth"
]  # crytek: samples above the tangent plane; depth: thesis 3.3.1
Pattern = Literal["random", "regular", "jittered", "halton", "hammersley", "noise"]  # noise: tile of the screen's size
Falloff = Literal["wendland", "gaussian"]
Axes = Literal[1, 2]

TILE_SIZES = range(2, 9)  # [pixels] possible sides of a pattern of sample directions
MAX_OCCLUSION_SAMPLES = 63  # largest number of samples across the occlusion kernel


@dataclass(frozen=True)
class Occlusion:
    """Parameters of ambient occlusion (thesis chapter 3)."""

    size: int = 11  # k samples across the kernel; k x k samples if exact, otherwise k per axis
    exact: bool = False  # whether all directions are sampled
    axes: Axes = 2  # perpendicular axes; 2 is separable, 1 misses occluders (Figure 3.9)
    estimator: Estimator = "angular"
    pattern: Pattern = "hammersley"  # distribution of directions over the pixels of a tile
    tile: int = 4  # [pixels] along a side of the tile and of the blur (listing 11.1)
    falloff: Falloff = "wendland"  # weight of occluders by distance (thesis 3.3)
    radius: float = 0.024  # [m] range of occluders
    strength: float = 1.4  # factor on the occlusion

    def __post_init__(self) -> None:
        if self.tile not in TILE_SIZES:
            raise DisplayError(
                f"a pattern of {self.tile} x {self.tile} pixels; use {TILE_SIZES[0]} to {TILE_SIZES[-1]}"
            )
        if not 2 <= self.size <= MAX_OCCLUSION_SAMPLES:
            raise DisplayError(f"occlusion with {self.size} samples across; use 2 to {MAX_OCCLUSION_SAMPLES}")

    @property
    def directions(self) -> int:
        """Number of sampled axes, each in two opposite directions."""
        return self.size if self.exact else self.axes


@dataclass(frozen=True)
class Scattering:
    """Parameters of subsurface scattering (thesis 5.1 and 5.2)."""

    width: float = 0.0035  # [m] spread of red light
    threshold: float = 0.93  # ambient light fraction above which smooth areas are not filtered; 1 filters all areas
    steps: int = 3  # number of samples on each side of a pixel
    levels: int = 1  # levels of detail; more occluded pixels use more samples (Figure 5.2)
    deep: float = 0.6  # ambient light fraction below which all samples are used

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
    """Parameters of the soft shadow of the key light (thesis 12.1)."""

    lamp: float = 0.15  # [m] width of the lamp; a wider lamp softens the shadow
    away: float = 1.2  # [m] distance of the lamp from the head's centre
    blockers: int = 4  # samples along a side of the blocker search
    taps: int = 6  # samples along a side of the depth comparison
    bilinear: bool = False  # whether each sample mixes the comparisons of four pixels of the map
    coloured: bool = False  # whether translucent layers tint the light
    reach: float = 0.22  # [m] half width covered by the map
    deep: float = 0.35  # [m] half depth covered by the map
    side: int = 512  # [pixels] along a side of the map
    sharpest: float = 0.004  # [m] minimum width of the comparison, because of the map's resolution


@dataclass(frozen=True)
class Focus:
    """Parameters of depth of field (thesis 12.1)."""

    circle: float = 0.03  # maximum radius of the circle of confusion, relative to picture height
    plane: float | None = None  # [m] depth of the sharp plane from the camera; None: depth of the nearer eye
    within: float = 0.03  # [m] sharp range before and behind the plane
    taps: int = 24  # samples per pixel


@dataclass(frozen=True)
class Preset:
    """Rendering effects and quality of a face picture.

    Each part can be changed with `dataclasses.replace`.
    """

    name: str
    subdivided: bool = False  # whether the mesh has four times the faces
    wrinkles: bool = True
    hair: bool = True  # whether hair has locks in addition to the painted scalp
    occlusion: Occlusion | None = None
    scattering: Scattering | None = None  # scattering in the skin, controlled by the occlusion if present
    shadow: Shadow | None = None
    focus: Focus | None = None
    eyeshade: bool = False  # whether the head wears an eyeshade
    coarse: int = 2  # [pixels] side of a block with common occlusion and shadow
    smooth: bool = True  # whether edges are smoothed
    samples: int = 1  # drawn pixels along a side of a displayed pixel


QUALITY_PRESETS: Mapping[str, Preset] = MappingProxyType(
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
                shadow=Shadow(blockers=6, taps=6, bilinear=True, coloured=True),
                focus=Focus(),
                samples=2,
            ),
        )
    }
)
DRAFT_PRESET = QUALITY_PRESETS["draft"]
NORMAL_PRESET = QUALITY_PRESETS["normal"]
FULL_PRESET = QUALITY_PRESETS["full"]
