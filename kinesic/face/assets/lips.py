"""Contact of the lips: no penetration, and no gap between pressed lips.

Shapes move each lip independently: a smile lifts the lower lip into the upper one. In columns from side to side, the
lowest point of the upper lip is compared with the highest point of the lower lip. Where they overlap, both yield, the
softer lower lip more; gaps of pressed lips are closed in the same manner. Points outside a column count, too, with an
extra distance proportional to their distance from it, so that points crossing a column cause no step.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import Mesh

JAW_SHAPE = "jawOpen"  # shape that moves the lower lip down
CORNER_JAW_FRACTION = 0.4  # skin that follows more than this fraction of the jaw's motion is lower lip
MOUTH_HALF_WIDTH = 0.40  # [eye distances] distance from the midline to the outermost lip column
MIN_LIP_FORWARD = 0.28  # [eye distances] smallest forward position of lip skin; skin behind lies inside the mouth
YIELDING_SKIN_RANGE = 0.42  # [eye distances] height above and below the mouth up to which the skin moves with the lips
EDGE_RANGE = 0.22  # [eye distances] height above and below the mouth within which the edge of a lip is searched
MIDDLE_RANGE = 0.2  # [eye distances] distance from the midline within which the lower lip defines the mouth's height
COLUMN_COUNT = 25  # number of vertical strips (columns) of the lips between the mouth corners
ASIDE_SLOPE = 6.0  # [m/m] height added to a lip point per lateral distance from its column, to find the lip edge
LOWER_LIP_FRACTION = 0.75  # fraction of a contact correction made by the lower lip; the upper lip makes the rest
CONTACT_OVERLAP = 0.0004  # [m] overlap of closed lips, so that no gap remains
CORNER_CONTACT_OVERLAP = 0.002  # [m] overlap at the corners, where a column is wider than the gap
STICKING_GAP = 0.001  # [m] gap scale over which lips stop sticking together


@dataclass(frozen=True, eq=False)
class Lips:
    """Upper and lower lip, divided into vertical columns from right to left."""

    skin: NDArray[np.intp]  # (k,) skin vertices that yield to the other lip
    yield_factors: Floats  # (k,) -1..1 upward motion per unit of overlap
    points: "scipy.sparse.csr_array"  # (n, v) interpolation of points on the upper, then the lower lip
    starts: NDArray[np.intp]  # (2,) index of the first point of each lip
    outward: Floats  # (n,) 1 on the upper lip, -1 on the lower one
    middles: Floats  # (c,) [m] lateral positions of the columns
    contact_overlap: Floats  # (c,) [m] overlap of closed lips

    def part(self, positions: Floats, seal: float, overlap: float = 0.0) -> None:
        """Separate or seal the lips by moving mesh vertices in place.

        Args:
            positions: (v, 3) [m] vertices after the shapes.
            seal: 0..1 fraction of the gap to close.
            overlap: [m] extra overlap of closed lips, which covers the teeth behind rolled lips.
        """
        gap = self.contact_overlap + overlap - self.overlap(positions)
        opened = np.maximum(gap, 0.0)
        stuck = opened * np.exp(-opened / STICKING_GAP)
        change = -np.where(gap < 0.0, gap, seal * gap + (1.0 - seal) * stuck)
        positions[self.skin, 2] += self.yield_factors * np.interp(positions[self.skin, 1], self.middles, change)

    def overlap(self, positions: Floats) -> Floats:
        """Return the (c,) overlap of the lips [m], negative for a gap."""
        aside, away = self.points @ positions[:, 1], self.outward * (self.points @ positions[:, 2])
        return -np.asarray(self._measure_column_edges(aside, away).sum(axis=0))

    def _measure_column_edges(self, aside: Floats, away: Floats) -> Floats:
        """Return the (2, c) heights [m] of lip edges in each column.

        Heights of the lower lip are negated, so that the sum of both rows is the gap.

        Args:
            aside: (n,) [m] lateral positions of points.
            away: (n,) [m] heights of the points, negated on the lower lip.
        """
        wide, count = self.middles[1] - self.middles[0], len(self.middles) + 2  # plus one outer column at each end
        right, left = self.middles - 0.5 * wide, self.middles + 0.5 * wide
        column = np.clip(((aside - right[0]) / wide + 1.0).astype(np.intp), 0, count - 1)
        column[self.starts[1] :] += count
        further = ASIDE_SLOPE * aside
        minima = np.full((3, 2 * count), np.inf)
        for least, values in zip(minima, (away, away - further, away + further), strict=True):
            np.minimum.at(least, column, values)
        within, right_side, behind = minima.reshape(3, 2, count)
        # outside its outermost points a lip has their distance
        first, last = (values.reduceat(further, self.starts)[:, None] for values in (np.minimum, np.maximum))
        right_side = np.minimum.accumulate(right_side, axis=1)[:, :-2] + np.clip(ASIDE_SLOPE * right, first, last)
        behind = np.minimum.accumulate(behind[:, ::-1], axis=1)[:, -3::-1] - np.clip(ASIDE_SLOPE * left, first, last)
        return np.asarray(np.minimum(within[:, 1:-1], np.minimum(right_side, behind)))


def find_lips(mesh: Mesh) -> Lips:
    """Find the lip skin and the vertical lip columns of a head."""
    unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = (mesh.positions / unit).T
    below = measure_jaw_following(mesh) > CORNER_JAW_FRACTION
    skin = (mesh.parts == 0) & (forward > MIN_LIP_FORWARD) & (np.abs(left) < MOUTH_HALF_WIDTH)
    away = np.abs(up - up[skin & below & (np.abs(left) < MIDDLE_RANGE)].max())
    skin &= away < YIELDING_SKIN_RANGE
    yield_factors = np.clip(1.25 * (1.0 - away / YIELDING_SKIN_RANGE), 0.0, 1.0) ** 2 * np.where(
        below, -LOWER_LIP_FRACTION, 1.0 - LOWER_LIP_FRACTION
    )
    middles = np.linspace(-MOUTH_HALF_WIDTH, MOUTH_HALF_WIDTH, COLUMN_COUNT) * unit
    aside = np.clip((np.abs(middles) / middles[-1] - 0.7) / 0.15, 0.0, 1.0)
    upper, lower = (_sample_points(mesh, skin & is_lip & (away < EDGE_RANGE)) for is_lip in (~below, below))
    return Lips(
        skin=np.flatnonzero(skin),
        yield_factors=yield_factors[skin],
        points=scipy.sparse.vstack([upper, lower], format="csr"),
        starts=np.array([0, upper.shape[0]]),
        outward=np.repeat([1.0, -1.0], [upper.shape[0], lower.shape[0]]),
        middles=middles,
        contact_overlap=CONTACT_OVERLAP + (CORNER_CONTACT_OVERLAP - CONTACT_OVERLAP) * aside,
    )


def measure_jaw_following(mesh: Mesh) -> Floats:
    """Return the (v,) relative downward displacement by a dropping jaw."""
    down = -mesh.deltas[:, [mesh.shapes.index(JAW_SHAPE)]].toarray().reshape(-1, 3)[:, 2]
    return np.asarray(down / down.max())


def _sample_points(mesh: Mesh, lip: NDArray[np.bool_]) -> "scipy.sparse.csr_array":
    """Return vertex weights (n, v) of points spread over a lip.

    They are vertices, edge midpoints, and three points in each triangle.
    """
    triangles = mesh.triangles[lip[mesh.triangles].all(axis=1)].astype(np.intp)
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)) @ (len(lip), 1)
    edges = np.stack(np.divmod(np.unique(ends), len(lip)), axis=1)
    corners = np.unique(triangles)[:, None]
    within = (np.roll(triangles, turn, axis=1) for turn in range(3))
    places = (np.repeat(corners, 3, axis=1), edges[:, [0, 1, 1]], *within)
    weights = ((1.0, 0.0, 0.0), (0.5, 0.5, 0.0), *3 * ((4 / 6, 1 / 6, 1 / 6),))
    values = np.repeat(weights, [len(corner_rows) for corner_rows in places], axis=0).ravel()
    count = len(values) // 3
    return scipy.sparse.csr_array(
        (values, np.concatenate(places).ravel(), np.arange(0, 3 * count + 1, 3)), shape=(count, len(lip))
    )
