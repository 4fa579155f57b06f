"""3D vectors and rotations as tuples, faster than small arrays."""

from math import sqrt

from kinesic.body.arrays import Floats
from kinesic.ik.angles import cosine_sine

Vector = tuple[float, float, float]
Rotation = tuple[float, float, float, float, float, float, float, float, float]  # row by row

IDENTITY_ROTATION: Rotation = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # 3 x 3 identity matrix, row by row


def vector(array: Floats) -> Vector:
    """Convert a (3,) array to a tuple of floats."""
    x, y, z = array.tolist()
    return x, y, z


def plus(a: Vector, b: Vector) -> Vector:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b, the vector from b to a."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scaled(a: Vector, factor: float) -> Vector:
    """Return a vector times a number."""
    return a[0] * factor, a[1] * factor, a[2] * factor


def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def norm(a: Vector) -> float:
    """Return the length of a vector."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def distance(a: Vector, b: Vector) -> float:
    """Return the distance between two points."""
    return norm(minus(a, b))


def unit(a: Vector) -> Vector:
    """Normalise a vector, keeping the zero vector."""
    length = norm(a)
    return scaled(a, 1.0 / length) if length > 0.0 else a


def across(a: Vector, axis: Vector) -> Vector:
    """Return a vector's component perpendicular to a unit axis."""
    return minus(a, scaled(axis, dot(a, axis)))


def clamp_to_reach(target: Vector, base: Vector, reach: float) -> Vector:
    """Move a target towards the base until its distance is within reach.

    The thesis prints the factor as d / D_max; it is D_max / d.

    Args:
        target: [m].
        base: [m] centre of the first joint.
        reach: [m] D_max.
    """
    d = distance(target, base)
    return target if d <= reach else plus(base, scaled(minus(target, base), reach / d))


def turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """Rotate a vector about a unit axis by an angle [rad].

    By Rodrigues' formula.
    """
    c, s = cosine_sine(angle)
    d = dot(axis, a) * (1.0 - c)
    x, y, z = cross(axis, a)
    return a[0] * c + x * s + axis[0] * d, a[1] * c + y * s + axis[1] * d, a[2] * c + z * s + axis[2] * d


def rotated(r: Rotation, a: Vector) -> Vector:
    """Multiply a vector by a rotation matrix."""
    x, y, z = a
    return r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z, r[6] * x + r[7] * y + r[8] * z


def within(r: Rotation, a: Vector) -> Vector:
    """Multiply a vector by the transpose of a rotation matrix."""
    x, y, z = a
    return r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z, r[2] * x + r[5] * y + r[8] * z


def after(r: Rotation, axis: Vector, angle: float) -> Rotation:
    """Rotate a frame by an angle about an axis in frame coordinates.

    That is R about(axis, angle) for a frame R, a unit axis and an angle [rad].
    """
    x, y, z = axis
    c, s = cosine_sine(angle)
    d = 1.0 - c
    xs, ys, zs = x * s, y * s, z * s
    xy, xz, yz = x * y * d, x * z * d, y * z * d
    a, b, e = c + x * x * d, xy - zs, xz + ys
    f, g, h = xy + zs, c + y * y * d, yz - xs
    i, j, k = xz - ys, yz + xs, c + z * z * d
    p, q, t, u, v, w, o, m, n = r
    return (
        p * a + q * f + t * i,
        p * b + q * g + t * j,
        p * e + q * h + t * k,
        u * a + v * f + w * i,
        u * b + v * g + w * j,
        u * e + v * h + w * k,
        o * a + m * f + n * i,
        o * b + m * g + n * j,
        o * e + m * h + n * k,
    )
