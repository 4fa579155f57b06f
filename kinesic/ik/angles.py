"""Trigonometric functions with bit-identical results on every machine.

A library's own differ from machine to machine in the last bit, and where hinges meet their stops a bit decides where a
search ends. These give the same bits everywhere, with the kernel and without, within three units in the last place.
"""

from math import copysign, pi, sqrt

ROUND_TO_INTEGER = 6755399441055744.0  # 1.5 x 2^52: adding and subtracting it rounds a float to an integer
TAN_PI_8 = 0.41421356237309504880  # tangent of pi / 8, the largest argument of the rational approximation


def cosine_sine(angle: float) -> tuple[float, float]:
    """Return cosine and sine of an angle [rad], bit-identical on all machines.

    Cody and Waite's reduction to an eighth of a turn, then the minimax polynomials of fdlibm.
    """
    quarters = (angle * (2.0 / pi) + ROUND_TO_INTEGER) - ROUND_TO_INTEGER
    x = (
        (angle - quarters * 1.57079632673412561417e00) - quarters * 6.07710050630396597660e-11
    ) - quarters * 2.02226624879595063154e-21
    z = x * x
    s = x + x * z * (
        -1.66666666666666324348e-01
        + z
        * (
            8.33333333332248946124e-03
            + z
            * (
                -1.98412698298579493134e-04
                + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))
            )
        )
    )
    c = (
        1.0
        - 0.5 * z
        + z
        * z
        * (
            4.16666666666666019037e-02
            + z
            * (
                -1.38888888888741095749e-03
                + z
                * (
                    2.48015872894767294178e-05
                    + z
                    * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))
                )
            )
        )
    )
    match int(quarters) & 3:
        case 0:
            return c, s
        case 1:
            return -s, c
        case 2:
            return -c, -s
        case _:
            return s, -c


def arctangent(y: float, x: float) -> float:
    """Return the angle [rad] of the point (x, y), like `math.atan2`."""
    across, along = abs(y), abs(x)
    less, more = min(across, along), max(across, along)
    angle = 0.0
    if less > TAN_PI_8 * more:
        angle = pi / 4.0 + _small((less - more) / (less + more))
    elif more > 0.0:
        angle = _small(less / more)
    if across > along:
        angle = pi / 2.0 - angle
    if copysign(1.0, x) < 0.0:
        angle = pi - angle
    return copysign(angle, y)


def arccosine(x: float) -> float:
    """Return the arc cosine of x, in 0..pi [rad]."""
    return 2.0 * arctangent(sqrt(1.0 - x), sqrt(1.0 + x))


def _small(t: float) -> float:
    """Approximate the arc tangent for |t| <= tan(pi / 8) (Cephes)."""
    z = t * t
    p = -6.485021904942025371773e1 + z * (
        -1.228866684490136173410e2
        + z * (-7.500855792314704667340e1 + z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1))
    )
    q = 1.945506571482613964425e2 + z * (
        4.853903996359136964868e2
        + z * (4.328810604912902668951e2 + z * (1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z)))
    )
    return t + t * (z * p / q)
