"""Skull that supports hair, and the roots of locks on it.

The skull is described by its radius in each direction from a point inside the head.
"""

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.chart import measure_hairline_height
from kinesic.face.assets.hair_styles import HairStyle
from kinesic.face.assets.late_scipy import scipy

HEAD_CENTRE = np.array([-1.15, 0.0, 0.30])  # origin of directions to the skull, in distances between the eyes
NEIGHBOUR_COUNT = 24  # number of skin vertices averaged for the skull radius in a direction
SMOOTHING_ANGLE = 0.08  # [rad] standard deviation of the weights in the average of the skull radius
MAX_EAR_SLOPE = 0.45  # slope at which hair rises over an ear and descends behind it
FRONT_EAR_FACTOR = 3.0  # factor on MAX_EAR_SLOPE in front of an ear, where hair descends more steeply
EAR_REGION = (
    -1.75,
    -0.95,
    -0.9,
    0.25,
    1.15,
)  # [eye distances] forward range, vertical range, minimum distance aside of an ear
SCALP_HEIGHT = 0.06  # [eye distances] smallest distance of locks from the scalp, reached at the height SCALP_RAMP
ROOT_HEIGHT = 0.015  # [eye distances] smallest distance of locks from the skin at the hairline
SCALP_RAMP = 0.35  # [eye distances] height over the hairline at which hair reaches its distance from the scalp
GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))  # [rad] turn between successive roots on the sphere
SIDEBURN_HEIGHT = 0.5  # [eye distances] height below which hair in front of the ears is only painted, without locks
HAIRLINE_ARC = 65.0  # [deg] angle to either side up to which the hairline has additional locks
HAIRLINE_SEED = 5  # seed of the random positions of the locks at the hairline
HAIRLINE_SPREAD = 0.10  # [eye distances] height over the hairline within which its additional locks begin
HAIRLINE_ITERATIONS = 12  # number of search steps for skull points on the hairline
# Forward position and height [eye distances] below which hair is only painted, without locks: on the neck, behind and
# in front of an ear.
LOWEST_ROOTS = ((-2.15, -0.55), (-1.95, 0.12), (EAR_REGION[0] - 0.01, 0.12), (EAR_REGION[0], SIDEBURN_HEIGHT))


def find_ear_points(points: Floats) -> NDArray[np.bool_]:
    """Return the mask of (..., 3) points that lie on an ear."""
    forward, left, up = np.moveaxis(points, -1, 0)
    back, front, low, high, aside = EAR_REGION
    return np.asarray((forward > back) & (forward < front) & (up > low) & (up < high) & (np.abs(left) > aside))


class Skull:
    """Skull surface that supports hair, as a radius for each direction."""

    def __init__(self, skin: Floats, style: HairStyle) -> None:
        skin = skin[skin[:, 2] > -1.6]
        ears = find_ear_points(skin)
        self._away, self._near = self._index_directions(skin[~ears])
        self._ears = self._index_directions(skin[ears]) if style.over_ears else None

    def radius(self, directions: Floats) -> Floats:
        """Return the (n,) skull radius in (n, 3) unit directions, without ears."""
        apart, which = self._near.query(directions, NEIGHBOUR_COUNT)
        weight = np.exp(-0.5 * (apart / SMOOTHING_ANGLE) ** 2)
        return np.asarray((weight * self._away[which]).sum(axis=1) / weight.sum(axis=1))

    def cover(self, directions: Floats) -> Floats:
        """Return the least distances (n,) [eye distances] of hair from `HEAD_CENTRE`."""
        radius = self.radius(directions)
        if self._ears is None:
            return radius
        away, near = self._ears
        apart = directions[:, None] - near.data
        apart[..., 0] *= np.where(apart[..., 0] > 0.0, FRONT_EAR_FACTOR, 1.0)
        apart = np.linalg.norm(apart, axis=2)
        return np.asarray(np.maximum(radius, (away - MAX_EAR_SLOPE * apart).max(axis=1)))

    @staticmethod
    def _index_directions(points: Floats) -> "tuple[Floats, scipy.spatial.cKDTree]":
        """Convert points to (n,) distances and a search tree of directions."""
        spokes = points - HEAD_CENTRE
        away = np.linalg.norm(spokes, axis=1)
        return away, scipy.spatial.cKDTree(spokes / away[:, None])

    def on(self, points: Floats, off: Floats, held: Floats) -> Floats:
        """Lift (n, 3) hair points to a minimum distance from the skull.

        The minimum is `cover` plus the scalp hair's height plus `off`. Points farther away are pulled towards it by
        the fraction `held`.
        """
        spokes = points - HEAD_CENTRE
        away = np.linalg.norm(spokes, axis=1)
        least = (
            self.cover(spokes / away[:, None])
            + np.interp(measure_hairline_height(points), (0.0, SCALP_RAMP), (ROOT_HEIGHT, SCALP_HEIGHT))
            + off
        )
        right = np.where(away < least, least, away + held * (least - away))
        return np.asarray(HEAD_CENTRE + spokes * (right / away)[:, None])


def find_roots(skull: Skull, style: HairStyle) -> Floats:
    """Return (r, 3) hair roots spread evenly over the hairy skin."""
    number = np.arange(style.roots) + 0.5
    up = 1.0 - 2.0 * number / style.roots
    aside = np.sqrt(1.0 - up * up)
    directions = np.stack([aside * np.cos(GOLDEN_ANGLE * number), aside * np.sin(GOLDEN_ANGLE * number), up], axis=1)
    points = HEAD_CENTRE + directions * skull.radius(directions)[:, None]
    points = np.concatenate([points, _find_hairline_points(skull, style)])
    return np.asarray(points[may_root(points, style)])


def may_root(points: Floats, style: HairStyle) -> NDArray[np.bool_]:
    """Return the mask (n,) of skull points that may carry hair roots."""
    lowest = np.interp(points[:, 0], *np.array(LOWEST_ROOTS).T)
    return np.asarray(
        ~find_ear_points(points) & (measure_hairline_height(points) > style.lowest) & (points[:, 2] > lowest)
    )


def _find_hairline_points(skull: Skull, style: HairStyle) -> Floats:
    """Return (h, 3) closely spaced points just above the hairline."""
    if not style.hairline_roots:
        return np.zeros((0, 3))
    random = np.random.default_rng(HAIRLINE_SEED)
    turns = np.radians(np.linspace(-HAIRLINE_ARC, HAIRLINE_ARC, style.hairline_roots))
    turns += random.uniform(-0.5, 0.5, len(turns)) * (turns[1] - turns[0])
    heights = style.lowest + 0.02 + HAIRLINE_SPREAD * random.uniform(0.0, 1.0, len(turns)) ** 2
    points = np.stack([np.cos(turns), np.sin(turns), np.zeros_like(turns)], axis=1)
    points[:, 0] += HEAD_CENTRE[0]
    for _ in range(HAIRLINE_ITERATIONS):
        points[:, 2] += heights - measure_hairline_height(points)
        spokes = points - HEAD_CENTRE
        spokes /= np.linalg.norm(spokes, axis=1, keepdims=True)
        points = HEAD_CENTRE + spokes * skull.radius(spokes)[:, None]
    return points
