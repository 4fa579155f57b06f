"""Hair styles of the heads."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from kinesic.body.choices import Variant


@dataclass(frozen=True)
class HairStyle:
    """Parameters of a hair style.

    Lengths are distances between the eyes.
    """

    roots: int  # candidate root directions on the sphere
    hairline_roots: int  # additional roots along the hairline
    lowest: float  # minimum height of a root over the hairline
    steps: int  # segments of a lock
    length: tuple[float, float]  # length of a lock at the temple and on top
    width: tuple[float, float]  # half width of a lock at the temple and on top
    tip: float  # relative width of the tip
    off: tuple[float, float]  # distance of the middle of a lock from the skull, at the temple and on top
    lies: float  # reduction of `off` at the tip of a lock, as a fraction
    cut: float  # minimum height of the ends of locks
    over_ears: bool  # whether hair covers the ears
    part: float | None  # lateral position of the parting; None: combed back
    face_off: float  # distance of a lock from the cheek / distance elsewhere
    curl: float  # component of the comb direction towards the cheek
    falls: float  # downward component of the comb direction at the sides


HAIR_STYLES: Mapping[Variant, HairStyle] = MappingProxyType(
    {
        "female": HairStyle(
            roots=1150,
            hairline_roots=160,
            lowest=0.02,
            steps=7,
            length=(2.0, 2.9),
            width=(0.125, 0.145),
            tip=0.5,
            off=(0.13, 0.19),
            lies=0.2,
            cut=-1.5,
            over_ears=True,
            part=0.2,
            face_off=0.1,
            curl=0.2,
            falls=0.9,
        ),
        "male": HairStyle(
            roots=960,
            hairline_roots=130,
            lowest=0.03,
            steps=5,
            length=(0.6, 1.3),
            width=(0.07, 0.13),
            tip=0.4,
            off=(0.04, 0.08),
            lies=0.7,
            cut=-0.83,
            over_ears=False,
            part=None,
            face_off=1.0,
            curl=0.0,
            falls=0.0,
        ),
    }
)
