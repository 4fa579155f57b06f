"""What is added to the expression shapes: cheeks that bulge, brows and rounded lips that go as far as a person's."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from kinesic.body.arrays import Floats

GAINS: Mapping[str, float] = MappingProxyType(  # of the source's shapes, whose brows and pursed lips stop half-way
    {
        "browInnerUp": 1.6,
        "browOuterUpLeft": 1.6,
        "browOuterUpRight": 1.6,
        "noseSneerLeft": 1.25,
        "noseSneerRight": 1.25,
        "mouthPucker": 1.5,
    }
)


@dataclass(frozen=True)
class Bulge:
    """A round part of the skin that moves outward and up."""

    aside: float  # of its middle, in distances between the eyes
    up: float
    reach: float  # where it ends
    outward: float  # [m]
    upward: float  # [m]


BULGES: Mapping[str, tuple[Bulge, ...]] = MappingProxyType(  # of the left side; the right one mirrors them
    {
        "mouthSmile": (Bulge(0.60, -0.58, 0.34, 0.0030, 0.0012),),
        "cheekSquint": (Bulge(0.58, -0.40, 0.34, 0.0032, 0.0015),),
    }
)
SIDES = {"Left": 1.0, "Right": -1.0}


def bulge(shape: str, rest: Floats, normals: Floats) -> Floats:
    """(v, 3) [m] what is added to a shape at (v, 3) places of the skin.

    Args:
        shape: its name.
        rest: in distances between the eyes, from the middle between them.
        normals: outward.
    """
    found = np.zeros_like(rest)
    for side, sign in SIDES.items():
        for each in BULGES.get(shape.removesuffix(side), ()) if shape.endswith(side) else ():
            away = np.hypot(rest[:, 1] * sign - each.aside, rest[:, 2] - each.up) / each.reach
            share = np.where(rest[:, 0] > 0.0, np.maximum(1.0 - away * away, 0.0) ** 2, 0.0)
            found += share[:, None] * (each.outward * normals + (0.0, 0.0, each.upward))
    return found
