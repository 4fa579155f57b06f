"""Grows hair: locks that are combed over the skull, as ribbons whose strands a shader draws.

A lock starts at its root and goes where a comb would take it, over a skull that is told as a radius in each direction
from a point inside the head. What it is combed from and to depends on the style.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import Variant
from kinesic.face.assets.chart import hair
from kinesic.face.assets.mesh import Mesh

INSIDE = np.array([-1.15, 0.0, 0.30])  # distances between the eyes: a point from which the whole skull is seen
NEAREST, EVENED = 24, 0.08  # vertices of the skin that say how far it is in a direction, and over which angle [rad]
SLOPE = 0.45  # at most, by which hair rises towards an ear, and falls behind it
EARS = (-1.75, -0.95, -0.9, 0.25, 1.15)  # from, to forward; from, to up; further aside: what short hair goes round
BENT = 0.35  # how far the normals at the edges of a lock lean outward
SEED = 11
SCALP, THICK = 0.06, 0.35  # that the painted scalp stands off, so far over the hairline
GOLDEN = np.pi * (3.0 - np.sqrt(5.0))
FREE = 0.1  # height below which a lock ends that is seen from inside, too
EACH = 2  # of so many of them one
ROOT, GROWN = (
    0.3,
    0.2,
)  # how wide a lock at the hairline begins, which has no steps so, and of its way, where it is wide
HAIRLINE = 0.3  # how far over it locks begin at their width
POINTED = 0.6  # of the way, from where a lock becomes narrower
EVEN = (0.93, 1.07)  # of its length that a lock has
LAYERS = (0.7, 1.0)  # of how far locks stand off
LET_GO = (-0.7, -0.1)  # height at which hair hangs free, and over which it lies on the skull
SHORTEST_LOCK = 0.9  # steps that are left of a lock, or it is cut off
CUT = (-0.06, 0.06)  # and by how much they differ there
TURNING = 0.55  # share of the comb's direction in that of a step


@dataclass(frozen=True)
class HairStyle:
    """How hair is worn; lengths are distances between the eyes."""

    roots: int  # directions of the sphere in which roots are looked for
    lowest: float  # height over the hairline of a root at least
    steps: int  # of a lock
    length: tuple[float, float]  # of a lock over the temple, and on top
    width: tuple[float, float]  # half of a lock, there and there
    tip: float  # how wide it ends
    off: tuple[float, float]  # from the skull, in the middle of a lock
    lies: float  # how much nearer its tip is
    cut: float  # height at which locks end at the lowest
    over_ears: bool  # else round them
    part: float | None  # to the left, where it is parted; else it is combed back
    falls: float  # how much it hangs, combed to a side


STYLES: Mapping[Variant, HairStyle] = MappingProxyType(
    {
        "female": HairStyle(
            roots=700,
            lowest=0.02,
            steps=7,
            length=(1.5, 2.7),
            width=(0.16, 0.16),
            tip=0.5,
            off=(0.12, 0.09),
            lies=0.2,
            cut=-1.5,
            over_ears=True,
            part=0.2,
            falls=0.9,
        ),
        "male": HairStyle(
            roots=1080,
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
            falls=0.0,
        ),
    }
)


@dataclass(frozen=True, eq=False)
class Locks:
    """Ribbons of hair in the head's frame."""

    positions: Floats  # (n, 3) [m]
    normals: Floats  # (n, 3) unit, outward
    places: Floats  # (n, 4) across -1..1, along 0..1, number of the lock 0..1, how bright it is
    triangles: NDArray[np.int32]  # (t, 3), anticlockwise from outside
    inside: NDArray[np.int32]  # (u, 3), of those that hang the other side


def grow(mesh: Mesh, style: HairStyle) -> Locks:
    """Grows the hair of a head at rest."""
    random = np.random.default_rng(SEED)
    unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    skin = mesh.positions[mesh.vertices("skin")] / unit
    skull = _Skull(skin, style)
    roots = _roots(skull, style)
    lines = _cut(_combed(skull, roots, style, random), style, random)
    return _ribbons(lines, style, random, unit)


def _on_ears(points: Floats) -> NDArray[np.bool_]:
    """(...) which of (..., 3) points are on an ear."""
    forward, left, up = np.moveaxis(points, -1, 0)
    back, front, low, high, aside = EARS
    return np.asarray((forward > back) & (forward < front) & (up > low) & (up < high) & (np.abs(left) > aside))


def _high(roots: Floats) -> Floats:
    """(r,) 0 at a root over the temple or on the neck, 1 on top."""
    return np.asarray(np.clip((roots[:, 2] + 0.1) / 1.2, 0.0, 1.0))


class _Skull:
    """How far the skin is in each direction, and what hair lies on."""

    def __init__(self, skin: Floats, style: HairStyle) -> None:
        skin = skin[skin[:, 2] > -1.6]
        ears = _on_ears(skin)
        self._away, self._near = self._seen(skin[~ears])
        self._ears = self._seen(skin[ears]) if style.over_ears else None

    def radius(self, directions: Floats) -> Floats:
        """(n,) in (n, 3) unit directions, evened out, without ears."""
        apart, which = self._near.query(directions, NEAREST)
        share = np.exp(-0.5 * (apart / EVENED) ** 2)
        return np.asarray((share * self._away[which]).sum(axis=1) / share.sum(axis=1))

    def cover(self, directions: Floats) -> Floats:
        """(n,) how far hair is at least; over ears it rises and falls no steeper than it may."""
        found = self.radius(directions)
        if self._ears is None:
            return found
        away, near = self._ears
        apart = np.linalg.norm(directions[:, None] - near.data, axis=2)
        return np.asarray(np.maximum(found, (away - SLOPE * apart).max(axis=1)))

    @staticmethod
    def _seen(points: Floats) -> tuple[Floats, scipy.spatial.cKDTree]:
        """(n,) how far (n, 3) points are from the inside of the head, and in which directions."""
        spokes = points - INSIDE
        away = np.linalg.norm(spokes, axis=1)
        return away, scipy.spatial.cKDTree(spokes / away[:, None])

    def on(self, points: Floats, off: Floats, held: Floats) -> Floats:
        """(n, 3) points (n,) off the skin: those that are nearer, and those further away by a share that is held."""
        spokes = points - INSIDE
        away = np.linalg.norm(spokes, axis=1)
        least = self.cover(spokes / away[:, None]) + SCALP * np.clip(hair(points) / THICK, 0.0, 1.0) + off
        right = np.where(away < least, least, away + held * (least - away))
        return np.asarray(INSIDE + spokes * (right / away)[:, None])


def _roots(skull: _Skull, style: HairStyle) -> Floats:
    """(r, 3) evenly over the skin that has hair."""
    number = np.arange(style.roots) + 0.5
    up = 1.0 - 2.0 * number / style.roots
    aside = np.sqrt(1.0 - up * up)
    directions = np.stack([aside * np.cos(GOLDEN * number), aside * np.sin(GOLDEN * number), up], axis=1)
    points = INSIDE + directions * skull.radius(directions)[:, None]
    return np.asarray(points[~_on_ears(points) & (hair(points) > style.lowest) & (points[:, 2] > -0.55)])


def _combed(skull: _Skull, roots: Floats, style: HairStyle, random: np.random.Generator) -> Floats:
    """(r, s + 1, 3) the middle lines of locks."""
    count = len(roots)
    high = _high(roots)
    lengths = np.interp(high, (0.0, 1.0), style.length) * random.uniform(*EVEN, count)
    off = np.interp(high, (0.0, 1.0), style.off)
    points, lines = roots.copy(), [roots]
    way = _comb(roots, style)
    layer = np.sort(random.uniform(*LAYERS, count))[::-1]  # those on top first, for the depth test
    wave = random.uniform(-0.15, 0.15, (count, 3))
    for step in range(style.steps):
        share = (step + 1) / style.steps
        way = (1.0 - TURNING) * way + TURNING * (_comb(points, style) + wave)
        outward = points - INSIDE
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        leaving = (way * outward).sum(axis=1, keepdims=True)
        held = np.clip((points[:, 2:] - LET_GO[0]) / (LET_GO[1] - LET_GO[0]), 0.0 if style.over_ears else 1.0, 1.0)
        way -= np.where(leaving < 0.0, 1.0, held) * leaving * outward
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        points = points + way * (lengths / style.steps)[:, None]
        points = skull.on(points, off * layer * (1.0 - (1.0 - share) ** 2 - style.lies * share**2), held[:, 0])
        lines.append(points)
    return np.stack(lines, axis=1)


def _cut(lines: Floats, style: HairStyle, random: np.random.Generator) -> Floats:
    """(r, s + 1, 3) lines that end where hair is cut, as many points on each as before."""
    count, rows = lines.shape[:2]
    heights = np.full((count, 1), style.cut) + random.uniform(*CUT, (count, 1))
    ears = np.zeros((count, rows), dtype=np.bool_) if style.over_ears else _on_ears(lines)
    gone = ears | (lines[:, :, 2] < heights)
    first = np.where(gone.any(axis=1), np.argmax(gone, axis=1), rows - 1)
    lock = np.arange(count)
    above, under = lines[lock, first - 1, 2], lines[lock, first, 2]
    back = np.where(ears[lock, first], 1.0, (heights[:, 0] - under) / np.maximum(above - under, 1e-9))
    ends = first - np.clip(back, 0.0, 1.0)
    lock = lock[ends > SHORTEST_LOCK]
    where = ends[lock, None] * np.linspace(0.0, 1.0, rows)
    before = np.minimum(where.astype(int), rows - 2)
    share = (where - before)[:, :, None]
    return np.asarray((1.0 - share) * lines[lock[:, None], before] + share * lines[lock[:, None], before + 1])


def _comb(points: Floats, style: HairStyle) -> Floats:
    """(n, 3) where hair at (n, 3) points is combed to."""
    forward, left, up = points.T
    side = np.ones(len(points)) if style.part is None else np.tanh((left - style.part) / 0.12)
    top = np.clip(up / 1.2, 0.0, 1.0)
    front = np.clip((forward + 0.9) / 0.8, 0.0, 1.0)
    if style.part is None:
        nape = np.clip((-1.4 - forward) / 0.6, 0.0, 1.0) * (1.0 - top)  # where hair lies on the neck
        ways = [-0.9 + 0.3 * front + 0.8 * nape, 0.3 * top, -0.05 - 0.5 * (1.0 - top) - 0.4 * nape]
    else:
        ways = [
            -0.75 * front - 0.05 - 0.6 * (1.0 - front) * top,
            1.2 * side * top**1.5,
            -0.35 - style.falls * (1.0 - top),
        ]
    found = np.stack([np.broadcast_to(each, left.shape) for each in ways], axis=1)
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _ribbons(lines: Floats, style: HairStyle, random: np.random.Generator, unit: float) -> Locks:
    """Ribbons of two vertices across, along lines."""
    count, rows = lines.shape[:2]
    along = np.linspace(0.0, 1.0, rows)
    way = np.gradient(lines, axis=1)
    way /= np.linalg.norm(way, axis=2, keepdims=True)
    out = lines - INSIDE
    out -= (out * way).sum(axis=2, keepdims=True) * way
    out /= np.linalg.norm(out, axis=2, keepdims=True)
    aside = np.cross(out, way)
    wide = (
        np.interp(_high(lines[:, 0]), (0.0, 1.0), style.width)[:, None]
        * (0.55 + 0.45 * np.sin(np.pi * along**0.7))
        * np.where(along > POINTED, 1.0 - (1.0 - style.tip) * ((along - POINTED) / (1.0 - POINTED)) ** 2, 1.0)
    )
    begun = ROOT + (1.0 - ROOT) * np.clip(hair(lines[:, 0]) / HAIRLINE, 0.0, 1.0)[:, None]
    wide = wide * np.minimum(begun + (1.0 - begun) * along / GROWN, 1.0)
    wide = wide[:, :, None] * random.uniform(0.75, 1.25, (count, 1, 1))
    across = np.array([-1.0, 1.0])
    points = lines[:, :, None] + across[:, None] * (wide * aside)[:, :, None]
    normals = out[:, :, None] + BENT * across[:, None] * aside[:, :, None]
    normals /= np.linalg.norm(normals, axis=3, keepdims=True)
    lock = random.uniform(0.0, 1.0, (2, count, 1, 1))
    places = np.stack(
        np.broadcast_arrays(across[None, None], along[None, :, None], lock[0], 0.85 + 0.3 * lock[1]), axis=-1
    )
    corner = np.arange(count * rows * 2).reshape(count, rows, 2)
    a, b, c, d = corner[:, :-1, :-1], corner[:, :-1, 1:], corner[:, 1:, 1:], corner[:, 1:, :-1]
    triangles = np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3).astype(np.int32)
    number = triangles[:, 0] // (2 * rows)
    hangs = (lines[number, :, 2].min(axis=1) < FREE) & (number % EACH == 0)  # from their roots: no step where it begins
    return Locks(
        positions=sealed(points.reshape(-1, 3) * unit),
        normals=sealed(normals.reshape(-1, 3)),
        places=sealed(places.reshape(-1, 4)),
        triangles=triangles,
        inside=triangles[hangs][:, ::-1],
    )
