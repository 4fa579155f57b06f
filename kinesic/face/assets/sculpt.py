"""What is added to the expression shapes: cheeks that bulge, brows and rounded lips that go as far as a person's.

What a smile does beside the mouth is evened out: the source crushes the skin there into a dent. It draws the lips back
on the teeth, from which they stand off in the source, and what lifts the upper lip lifts its middle as well.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.face.assets.chart import mouth
from kinesic.face.assets.lips import CORNER as LOWER
from kinesic.face.assets.mesh import PARTS, Mesh

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
        "cheekSquint": (Bulge(0.58, -0.39, 0.37, 0.0065, 0.0020),),
    }
)
EVENED = "mouthSmile"  # the shape of which neighbours move alike beside the mouth
BESIDE = (0.68, -1.0)  # where that is, aside and up, in distances between the eyes
AROUND = 0.5  # how far from there it ends, after half of which it is less
CORNER = (0.42, 0.56)  # from where to where, going aside, it begins: the corner of the mouth keeps its way
AT_LEAST = -0.3  # how far forward
LIPS: Mapping[str, tuple[float, float, float]] = MappingProxyType(  # [m] forward and up by either side's shape, at the
    {  # middle of the mouth, and how far aside that ends, in distances between the eyes
        "mouthSmile": (-0.0018, 0.0, 0.38),
        "mouthUpperUp": (0.0, 0.0012, 0.32),
    }
)
MEET = -1.09  # how high lips meet
NEAR_LIPS = (0.12, 0.36)  # from there up and down, within which all of a lip moves, and where that ends
TEETH = 0.25  # how far forward what lies before the teeth is
TIMES = 24  # that each vertex takes the mean of its neighbours
SIDES = {"Left": 1.0, "Right": -1.0}


def shape_bulge(shape: str, rest: Floats, normals: Floats) -> Floats:
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


def even_out(shape: str, moves: Floats, head: Mesh) -> Floats:
    """(v, 3) [m] what a shape adds, without a dent beside the mouth.

    Args:
        shape: its name.
        moves: (v, 3) [m] what it adds so far.
        head: at rest.
    """
    side = shape.removeprefix(EVENED)
    if side not in SIDES:
        return moves
    forward, left, up = (head.positions / (head.eyes[0, 1] - head.eyes[1, 1])).T
    aside = SIDES[side] * left
    share = np.clip(2.0 * (1.0 - np.hypot(aside - BESIDE[0], up - BESIDE[1]) / AROUND), 0.0, 1.0)
    share *= np.clip((aside - CORNER[0]) / (CORNER[1] - CORNER[0]), 0.0, 1.0)
    outside = (head.parts == PARTS.index("skin")) & (mouth(head) == 0.0) & (forward > AT_LEAST)
    share = np.where(outside, share, 0.0)[:, None]
    mean = _mean_of_neighbours(head)
    for _ in range(TIMES):
        moves = moves + share * (mean @ moves - moves)
    return moves


def settle_lips(shape: str, moves: Floats, head: Mesh, falls: Floats) -> Floats:
    """(v, 3) [m] what a shape adds, with what `LIPS` adds to it.

    Args:
        shape: its name.
        moves: (v, 3) [m] what it adds so far.
        head: at rest.
        falls: (v,) 0..1 how far a dropping jaw takes each vertex along, against what it moves most.
    """
    kind = shape.removesuffix("Left").removesuffix("Right")
    if kind not in LIPS:
        return moves
    forward, up, aside = LIPS[kind]
    rest = head.positions / (head.eyes[0, 1] - head.eyes[1, 1])
    away = np.abs(rest[:, 2] - MEET)
    share = np.maximum(1.0 - (rest[:, 1] / aside) ** 2, 0.0) ** 2
    share *= np.clip((NEAR_LIPS[1] - away) / (NEAR_LIPS[1] - NEAR_LIPS[0]), 0.0, 1.0)
    share *= (head.parts == PARTS.index("skin")) & (rest[:, 0] > TEETH)
    upper = np.clip(1.0 - falls / LOWER, 0.0, 1.0)
    return np.asarray(moves + np.stack([forward * share, np.zeros(len(rest)), up * upper * share], axis=1))


def _mean_of_neighbours(mesh: Mesh) -> "scipy.sparse.csr_array":
    """(v, v) which takes the mean over the vertices at the other ends of edges."""
    ends = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    pairs = np.unique(np.concatenate([ends, ends[:, ::-1]]), axis=0)
    count = np.bincount(pairs[:, 0], minlength=len(mesh.positions))
    return scipy.sparse.csr_array((1.0 / count[pairs[:, 0]], tuple(pairs.T)), shape=2 * (len(mesh.positions),))
