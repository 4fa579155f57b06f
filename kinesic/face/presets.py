"""How much is drawn: from a draft for slow machines to everything."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.body.config import closest
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
    coarse: int = 2  # pixels of the picture along a side of one of the occlusion
    radius: float = 0.024  # [m] within which surfaces occlude
    strength: float = 1.7


@dataclass(frozen=True)
class Scattering:
    """Light that spreads under the skin (thesis 5.1 and 5.2)."""

    width: float = 0.0035  # [m] that red light spreads
    threshold: float = 0.93  # of openness: only pixels occluded more than this are filtered; 1 filters all


@dataclass(frozen=True)
class Preset:
    """What a picture is drawn with; each part can be switched with `dataclasses.replace`."""

    name: str
    subdivided: bool = False  # four times the faces
    wrinkles: bool = True
    occlusion: Occlusion | None = None
    scattering: Scattering | None = None  # needs occlusion, which steers it
    shadow: bool = False  # of the key light
    smooth: bool = True  # edges
    samples: int = 1  # pixels drawn along each side of a pixel shown


PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        preset.name: preset
        for preset in (
            Preset("draft", wrinkles=False, smooth=False),
            Preset("normal", shadow=True, occlusion=Occlusion(), scattering=Scattering()),
            Preset(
                "full",
                subdivided=True,
                occlusion=Occlusion(size=21),
                scattering=Scattering(threshold=1.0),
                shadow=True,
                samples=2,
            ),
        )
    }
)
DRAFT, NORMAL, FULL = PRESETS.values()


def preset(name: str) -> Preset:
    """The preset of a name.

    Raises:
        DisplayError: there is none.
    """
    if name not in PRESETS:
        raise DisplayError(f"no preset {name}{closest(name, list(PRESETS))}; there are {', '.join(PRESETS)}")
    return PRESETS[name]
