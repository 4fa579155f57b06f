"""Hair as combed locks: ribbons with strands drawn by a shader.

A lock starts at its root and follows the comb direction over a skull, which is described by its radius in each
direction from a point inside the head. The style (`hair_styles.py`) determines the comb direction.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.chart import compute_vertex_chart, measure_hairline_height
from kinesic.face.assets.hair_roots import (
    EAR_REGION,
    HEAD_CENTRE,
    SCALP_RAMP,
    SIDEBURN_HEIGHT,
    Skull,
    find_ear_points,
    find_roots,
    may_root,
)
from kinesic.face.assets.hair_styles import HairStyle
from kinesic.face.assets.mesh import MESH_PARTS, Mesh

NORMAL_LEAN = 0.35  # sideways / outward component of the normals at the edges of a lock
HAIR_SEED = 11  # seed of the random generator for hair
PAINTED_HAIR_HEIGHT = 0.0035  # [m] distance of painted hair from the scalp, reached at the height SCALP_RAMP
INSIDE_VISIBLE_HEIGHT = -0.4  # [eye distances] height below which the inside of hanging locks is visible
INSIDE_STRIDE = 3  # every third hanging lock is also drawn from inside
ROOT_WIDTH = 0.6  # width of a lock at the hairline / its full width; small, so that the hairline looks smooth
GROWTH_FRACTION = 0.3  # fraction of a lock within which it reaches its full width
FULL_WIDTH_DISTANCE = 0.5  # [eye distances] height over hairline and sideburns from which locks start at full width
TAPER_START = 0.6  # fraction of a lock from which it narrows
LENGTH_VARIATION = (0.93, 1.07)  # range of the random factor on a lock's length
LAYER_RANGE = (0.7, 1.0)  # range of the random factor on a lock's distance from the skull
HANGING_RANGE = (-0.7, -0.1)  # [eye distances] heights between which hair changes from hanging to following the skull
MIN_LOCK_STEPS = 0.9  # [steps along a lock] length below which a lock is removed
CUT_VARIATION = (-0.06, 0.06)  # [eye distances] range of the random offset of the height at which hair is cut
UPSTREAM_SHIFT = 0.2  # [eye distances] largest shift of a lock's start from its root, against the comb direction
FACE_RANGE = (-1.3, -0.6)  # [eye distances] forward positions between which hair comes to lie on the cheek
COMB_VARIATION = 0.15  # largest random component of the comb direction of a lock
LOOSE_FRACTION = 0.12  # fraction of locks that leave the comb direction
LOOSE_WAVE_FACTOR = 1.8  # factor on the random component of the comb direction of loose locks
LOOSE_LAYER = 1.1  # factor on the distance of loose locks from the skull
THIN_FRACTION = 0.15  # fraction of locks that are single strands
THIN_WIDTH = 0.3  # factor on the width of single strands
RISING_HEIGHT = 0.35  # [eye distances] height scale over the hairline within which parted hair rises backwards
COMB_WEIGHT = 0.55  # weight 0..1 of the comb direction in each step along a lock


@dataclass(frozen=True, eq=False)
class Locks:
    """Ribbons that represent locks of hair, in the head's frame."""

    positions: Floats  # (n, 3) [m]
    normals: Floats  # (n, 3) unit, outward
    strands: Floats  # (n, 3) unit, from root to tip
    places: Floats  # (n, 4) across -1..1, along 0..1, random number of the lock 0..1, brightness
    triangles: NDArray[np.int32]  # (t, 3), anticlockwise from outside
    inside: NDArray[np.int32]  # (u, 3) back faces of hanging locks


def measure_painted_hair(mesh: Mesh) -> Floats:
    """Return the (v,) distance [m] of the painted hair from the scalp."""
    over = np.clip(compute_vertex_chart(mesh)[:, 3] / SCALP_RAMP, 0.0, 1.0)
    return sealed(PAINTED_HAIR_HEIGHT * over * (mesh.parts == MESH_PARTS.index("skin")))


def grow_locks(mesh: Mesh, style: HairStyle) -> Locks:
    """Return the locks of hair of a head at rest."""
    random = np.random.default_rng(HAIR_SEED)
    unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    skin = mesh.positions[mesh.vertices("skin")] / unit
    skull = Skull(skin, style)
    roots = find_roots(skull, style)
    lines = _cut_locks(_comb_locks(skull, roots, style, random), style, random)
    return _build_ribbons(lines, style, random, unit)


def _rate_root_height(roots: Floats) -> Floats:
    """Return (r,) relative heights of hair roots, 0 (temple) to 1 (top)."""
    return np.asarray(np.clip((roots[:, 2] + 0.1) / 1.2, 0.0, 1.0))


def _measure_border_distance(roots: Floats) -> Floats:
    """Return the smaller of each root's heights over hairline and sideburns, (r,)."""
    over_sideburns = np.where(roots[:, 0] > EAR_REGION[0], roots[:, 2] - SIDEBURN_HEIGHT, np.inf)
    return np.asarray(np.minimum(measure_hairline_height(roots), over_sideburns))


def _comb_locks(skull: Skull, roots: Floats, style: HairStyle, random: np.random.Generator) -> Floats:
    """Return the (r, s + 1, 3) centre lines of locks."""
    count = len(roots)
    high = _rate_root_height(roots)
    lengths = np.interp(high, (0.0, 1.0), style.length) * random.uniform(*LENGTH_VARIATION, count)
    off = np.interp(high, (0.0, 1.0), style.off)
    direction = _find_comb_directions(roots, style)
    shift = np.clip(0.7 * (_measure_border_distance(roots) - style.lowest - 0.05), 0.0, UPSTREAM_SHIFT)
    upstream = skull.on(roots - shift[:, None] * direction, np.zeros(count), np.ones(count))
    points = np.where(may_root(upstream, style)[:, None], upstream, roots)
    lines = [points]
    layer = np.sort(random.uniform(*LAYER_RANGE, count))[::-1]  # upper layers first, for the depth test
    loose = random.uniform(0.0, 1.0, (count, 1)) < LOOSE_FRACTION
    wave = random.uniform(-COMB_VARIATION, COMB_VARIATION, (count, 3)) * np.where(loose, LOOSE_WAVE_FACTOR, 1.0)
    layer = np.where(loose[:, 0], LOOSE_LAYER, layer)
    for step in range(style.steps):
        progress = (step + 1) / style.steps
        direction = (1.0 - COMB_WEIGHT) * direction + COMB_WEIGHT * (_find_comb_directions(points, style) + wave)
        outward = points - HEAD_CENTRE
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        leaving = (direction * outward).sum(axis=1, keepdims=True)
        hanging = np.interp(points[:, 2:], HANGING_RANGE, (0.0 if style.over_ears else 1.0, 1.0))
        held = np.maximum(hanging, np.interp(points[:, :1], FACE_RANGE, (0.0, 1.0)))
        direction -= np.where(leaving < 0.0, 1.0, held) * leaving * outward
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        points = points + direction * (lengths / style.steps)[:, None]
        close = np.interp(points[:, 0], FACE_RANGE, (1.0, style.face_off))
        points = skull.on(
            points, off * close * layer * (1.0 - (1.0 - progress) ** 2 - style.lies * progress**2), held[:, 0]
        )
        lines.append(points)
    return np.stack(lines, axis=1)


def _cut_locks(lines: Floats, style: HairStyle, random: np.random.Generator) -> Floats:
    """Cut the centre lines of locks at ears and a minimum height.

    Lines have the shape (r, s + 1, 3). Locks shorter than `MIN_LOCK_STEPS` are removed. All lines keep the same number
    of points.
    """
    count, rows = lines.shape[:2]
    heights = np.full((count, 1), style.cut) + random.uniform(*CUT_VARIATION, (count, 1))
    ears = np.zeros((count, rows), dtype=np.bool_) if style.over_ears else find_ear_points(lines)
    gone = ears | (lines[:, :, 2] < heights)
    first = np.where(gone.any(axis=1), np.argmax(gone, axis=1), rows - 1)
    lock = np.arange(count)
    above, under = lines[lock, first - 1, 2], lines[lock, first, 2]
    back = np.where(ears[lock, first], 1.0, (heights[:, 0] - under) / np.maximum(above - under, 1e-9))
    ends = first - np.clip(back, 0.0, 1.0)
    lock = lock[ends > MIN_LOCK_STEPS]
    where = ends[lock, None] * np.linspace(0.0, 1.0, rows)
    lower = np.minimum(where.astype(int), rows - 2)
    fraction = (where - lower)[:, :, None]
    return np.asarray((1.0 - fraction) * lines[lock[:, None], lower] + fraction * lines[lock[:, None], lower + 1])


def _find_comb_directions(points: Floats, style: HairStyle) -> Floats:
    """Return the (n, 3) comb directions of hair at (n, 3) points."""
    forward, left, up = points.T
    side = np.ones(len(points)) if style.part is None else np.tanh((left - style.part) / 0.12)
    top = np.clip(up / 1.2, 0.0, 1.0)
    front = np.clip((forward + 0.9) / 0.8, 0.0, 1.0)
    if style.part is None:
        nape = np.clip((-1.4 - forward) / 0.6, 0.0, 1.0) * (1.0 - top)  # 1 where hair lies on the neck
        components = [-0.9 + 0.3 * front + 0.8 * nape, 0.3 * top, -0.05 - 0.5 * (1.0 - top) - 0.4 * nape]
    else:
        rising = front * np.exp(-((np.maximum(measure_hairline_height(points), 0.0) / RISING_HEIGHT) ** 2))
        rising *= np.clip((top - 0.55) / 0.3, 0.0, 1.0)
        components = [
            -0.25 * front * top + 0.10 * front * (1.0 - top) - 0.02 - 0.6 * (1.0 - front) * top - rising,
            1.2 * side * top**1.5 * (1.0 - 0.6 * rising) - style.curl * np.sign(left) * (1.0 - top) * front,
            -0.35 - style.falls * (1.0 - top) + 0.5 * rising,
        ]
    directions = np.stack([np.broadcast_to(component, left.shape) for component in components], axis=1)
    return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def _build_ribbons(lines: Floats, style: HairStyle, random: np.random.Generator, unit: float) -> Locks:
    """Build hair ribbons, two vertices wide, along the lines of locks."""
    count, rows = lines.shape[:2]
    along = np.linspace(0.0, 1.0, rows)
    tangents = np.gradient(lines, axis=1)
    tangents /= np.linalg.norm(tangents, axis=2, keepdims=True)
    out = lines - HEAD_CENTRE
    out -= (out * tangents).sum(axis=2, keepdims=True) * tangents
    out /= np.linalg.norm(out, axis=2, keepdims=True)
    aside = np.cross(out, tangents)
    wide = (
        np.interp(_rate_root_height(lines[:, 0]), (0.0, 1.0), style.width)[:, None]
        * (0.55 + 0.45 * np.sin(np.pi * along**0.7))
        * np.where(
            along > TAPER_START, 1.0 - (1.0 - style.tip) * ((along - TAPER_START) / (1.0 - TAPER_START)) ** 2, 1.0
        )
    )
    inside = np.clip(_measure_border_distance(lines[:, 0]) / FULL_WIDTH_DISTANCE, 0.0, 1.0)
    begun = ROOT_WIDTH + (1.0 - ROOT_WIDTH) * inside[:, None]
    wide = wide * np.minimum(begun + (1.0 - begun) * along / GROWTH_FRACTION, 1.0)
    thin = random.uniform(0.0, 1.0, (count, 1, 1))
    wide = wide[:, :, None] * np.where(thin < THIN_FRACTION, THIN_WIDTH, 0.75 + 0.5 * thin)
    across = np.array([-1.0, 1.0])
    points = lines[:, :, None] + across[:, None] * (wide * aside)[:, :, None]
    normals = out[:, :, None] + NORMAL_LEAN * across[:, None] * aside[:, :, None]
    normals /= np.linalg.norm(normals, axis=3, keepdims=True)
    lock = random.uniform(0.0, 1.0, (2, count, 1, 1))
    places = np.stack(
        np.broadcast_arrays(across[None, None], along[None, :, None], lock[0], 0.85 + 0.3 * lock[1]), axis=-1
    )
    corner = np.arange(count * rows * 2).reshape(count, rows, 2)
    a, b, c, d = corner[:, :-1, :-1], corner[:, :-1, 1:], corner[:, 1:, 1:], corner[:, 1:, :-1]
    triangles = np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3).astype(np.int32)
    number = triangles[:, 0] // (2 * rows)
    hangs = (lines[number, :, 2].min(axis=1) < INSIDE_VISIBLE_HEIGHT) & (
        number % INSIDE_STRIDE == 0
    )  # decided per lock, to avoid steps within a lock
    return Locks(
        positions=sealed(points.reshape(-1, 3) * unit),
        normals=sealed(normals.reshape(-1, 3)),
        strands=sealed(np.repeat(tangents, 2, axis=1).reshape(-1, 3)),
        places=sealed(places.reshape(-1, 4)),
        triangles=triangles,
        inside=triangles[hangs][:, ::-1],
    )
