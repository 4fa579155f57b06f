"""Hand orientations from pointing and palm directions."""

from kinesic.body.chain import Chain
from kinesic.ik.scalar3 import Rotation, Vector, across, cross, norm, rotated, unit, vector

PARALLEL_SINE = 1e-6  # sine of the angle below which two directions are parallel


def orientation_of(chain: Chain, pointing: Vector, palm: Vector) -> Rotation | None:
    """Return the hand's rotation matrix for pointing and palm, None if parallel.

    Args:
        chain: the arm whose hand it is.
        pointing: unit, in the frame of the chain's base.
        palm: unit; where it and `pointing` are not as far apart as on the hand, it is met as nearly as they allow.

    Returns:
        Of the last segment, in the frame of the chain's base; None where the palm lies along the pointing.
    """
    along = unit(vector(chain.joints[-1].bone))
    hand_palm, target_palm = across(unit(vector(chain.palm)), along), across(palm, pointing)
    if norm(hand_palm) < PARALLEL_SINE or norm(target_palm) < PARALLEL_SINE:
        return None
    return product(_triad(pointing, unit(target_palm)), transposed(_triad(along, unit(hand_palm))))


def product(left: Rotation, right: Rotation) -> Rotation:
    """Return the product of two rotation matrices."""
    return _of_columns(*(rotated(left, column) for column in (right[0::3], right[1::3], right[2::3])))


def transposed(r: Rotation) -> Rotation:
    """Return the transposed (inverse) rotation matrix."""
    return r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]


def _triad(along: Vector, aside: Vector) -> Rotation:
    """Return the rotation matrix with two given orthonormal first columns."""
    return _of_columns(along, aside, cross(along, aside))


def _of_columns(a: Vector, b: Vector, c: Vector) -> Rotation:
    return a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]
