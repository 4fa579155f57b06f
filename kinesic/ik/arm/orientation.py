"""Whole orientations of the hand: what two directions make, and the shortest turn from one to another."""

from math import pi

from kinesic.body.chain import Chain
from kinesic.ik.angles import arctangent
from kinesic.ik.scalar3 import Rotation, Vector, across, cross, norm, rotated, scaled, unit, vector

LIKE = 1e-6  # [rad] nearer than this to the other one, a direction says nothing


def orientation_of(chain: Chain, pointing: Vector, palm: Vector) -> Rotation | None:
    """Finds the orientation of a hand that points and faces as asked.

    Args:
        chain: the arm whose hand it is.
        pointing: unit, in the frame of the chain's base.
        palm: unit; where it and `pointing` are not as far apart as on the hand, it is met as nearly as they allow.

    Returns:
        Of the last segment, in the frame of the chain's base; None where the palm lies along the pointing.
    """
    along = unit(vector(chain.joints[-1].bone))
    own, seen = across(unit(vector(chain.palm)), along), across(palm, pointing)
    if norm(own) < LIKE or norm(seen) < LIKE:
        return None
    return product(_triad(pointing, unit(seen)), transposed(_triad(along, unit(own))))


def shortest_turn(present: Rotation, wanted: Rotation) -> Vector:
    """Finds the shortest turn from one orientation to another [rad]: axis times angle, in the base."""
    a, b, c, d, e, f, g, h, i = product(wanted, transposed(present))
    axis, twice_cosine = (h - f, c - g, d - b), a + e + i - 1.0
    twice_sine = norm(axis)
    if twice_sine < 1e-12 and twice_cosine < 0.0:
        widest = max(range(3), key=lambda k: (a, e, i)[k])
        return scaled(unit(((a + 1.0, b, c), (d, e + 1.0, f), (g, h, i + 1.0))[widest]), pi)
    return scaled(axis, arctangent(twice_sine, twice_cosine) / twice_sine if twice_sine > 0.0 else 0.5)


def product(left: Rotation, right: Rotation) -> Rotation:
    """Multiplies two rotations: first the right one, then the left one."""
    return _of_columns(*(rotated(left, column) for column in (right[0::3], right[1::3], right[2::3])))


def transposed(r: Rotation) -> Rotation:
    """Turns a rotation back."""
    return r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]


def _triad(along: Vector, aside: Vector) -> Rotation:
    """Columns: two unit vectors that are perpendicular, and the third."""
    return _of_columns(along, aside, cross(along, aside))


def _of_columns(a: Vector, b: Vector, c: Vector) -> Rotation:
    return a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]
