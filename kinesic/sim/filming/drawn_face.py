"""Paints a plain face from action units, for a head whose screen has no rendered one: two eyes, brows and a mouth."""

from collections.abc import Mapping

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture

GROUND, LIGHT, PUPIL = (20, 26, 38), (214, 240, 250), (14, 20, 32)
FINER = 2  # pixels that are painted along a side of one
SIZE = (320, 240)  # [pixels] in which the numbers below are
SCREEN = (240, 180)  # [pixels] of a face on a head's screen, which is a hundred wide or so in a film
EYE, EYE_HIGH, EYE_APART = (30.0, 38.0), 98.0, 68.0  # half axes, height from the top, from the middle
PUPIL_AXES = (16.0, 20.0)  # half axes of a pupil
LOOKS = (12.0, 15.0)  # that a pupil moves at the end of its range
BROW, BROW_LIFT = 46.0, 18.0  # above the eye, and how far it moves
MOUTH_HIGH, MOUTH = 184.0, 46.0  # height from the top, half its width


def paint_face(units: Mapping[str, float], *, size: tuple[int, int] = SIZE) -> Picture:
    """Paints what action units show.

    Args:
        units: action unit -> 0..1, as in `Command.face`.
        size: width and height, in pixels.
    """
    picture = Image.new("RGB", (FINER * size[0], FINER * size[1]), GROUND)
    pen, scale = ImageDraw.Draw(picture), FINER * size[0] / SIZE[0]
    for side, sign in (("R", -1.0), ("L", 1.0)):  # its right is at our left
        _paint_eye(pen, scale, units, side, sign)
    _paint_mouth(pen, scale, units)
    return np.asarray(picture.reduce(FINER))


def shown_intensity(units: Mapping[str, float], number: int, side: str = "") -> float:
    """The intensity of an action unit on a side, 0..1."""
    return max(units.get(str(number), 0.0), units.get(f"{side}{number}", 0.0) if side else 0.0)


def _paint_eye(pen: ImageDraw.ImageDraw, scale: float, units: Mapping[str, float], side: str, sign: float) -> None:
    closed = max(shown_intensity(units, number, side) for number in (43, 45, 46))
    open_share = max(1.0 - closed - 0.25 * shown_intensity(units, 7, side) - 0.2 * shown_intensity(units, 6, side), 0.0)
    tall = EYE[1] * open_share * (1.0 + 0.2 * shown_intensity(units, 5, side))
    x, y = SIZE[0] / 2 + sign * EYE_APART, EYE_HIGH
    if tall < 3.0:
        pen.line(_scaled([(x - EYE[0], y), (x + EYE[0], y)], scale), fill=LIGHT, width=round(5 * scale))
    else:
        pen.ellipse(_scaled([(x - EYE[0], y - tall), (x + EYE[0], y + tall)], scale), fill=LIGHT)
        across = shown_intensity(units, 61) - shown_intensity(units, 62) - sign * 0.4 * shown_intensity(units, 66)
        px, py = (
            x + LOOKS[0] * across,
            y + LOOKS[1] * (shown_intensity(units, 64) - shown_intensity(units, 63)) * open_share,
        )
        high = min(PUPIL_AXES[1], 0.9 * tall)
        pen.ellipse(_scaled([(px - PUPIL_AXES[0], py - high), (px + PUPIL_AXES[0], py + high)], scale), fill=PUPIL)
    frown = 0.6 * shown_intensity(units, 4, side)
    inner, outer = (
        BROW_LIFT * (shown_intensity(units, number, side) - frown * share) for number, share in ((1, 1.0), (2, 0.4))
    )
    ends = [(x - sign * EYE[0], y - BROW - inner), (x, y - BROW - 5 - (inner + outer) / 2)]
    ends.append((x + sign * EYE[0], y - BROW - outer))
    pen.line(_scaled(ends, scale), fill=LIGHT, width=round(7 * scale), joint="curve")


def _paint_mouth(pen: ImageDraw.ImageDraw, scale: float, units: Mapping[str, float]) -> None:
    narrow = max(shown_intensity(units, 18), 0.7 * shown_intensity(units, 22), 0.4 * shown_intensity(units, 23))
    opened = max(
        0.35 * shown_intensity(units, 25),
        shown_intensity(units, 26),
        1.3 * shown_intensity(units, 27),
        0.25 * shown_intensity(units, 22),
    )
    opened *= 1.0 - max(shown_intensity(units, 24), shown_intensity(units, 28))
    corners = {}
    for side, sign in (("R", -1.0), ("L", 1.0)):
        smile, sad, wide = (shown_intensity(units, number, side) for number in (12, 15, 20))
        half = MOUTH * (1.0 + 0.25 * smile + 0.2 * wide - 0.5 * narrow)
        corners[sign] = (SIZE[0] / 2 + sign * half, MOUTH_HIGH - 18.0 * smile + 14.0 * sad)
    drop, middle = 42.0 * opened, MOUTH_HIGH + 4.0 - 4.0 * shown_intensity(units, 17)
    upper, lower = _arc(corners, middle - 0.2 * drop), _arc(corners, middle + 0.8 * drop)
    pen.polygon(_scaled([*upper, *reversed(lower)], scale), fill=PUPIL)
    pen.line(_scaled([*upper, *reversed(lower), upper[0]], scale), fill=LIGHT, width=round(6 * scale), joint="curve")


def _arc(corners: Mapping[float, tuple[float, float]], middle: float) -> list[tuple[float, float]]:
    """Points of a curve from corner to corner that passes the middle at a height."""
    (x0, y0), (x2, y2) = corners[-1.0], corners[1.0]
    x1, y1 = (x0 + x2) / 2, 2 * middle - (y0 + y2) / 2
    shares = [k / 16 for k in range(17)]
    return [
        ((1 - s) ** 2 * x0 + 2 * s * (1 - s) * x1 + s * s * x2, (1 - s) ** 2 * y0 + 2 * s * (1 - s) * y1 + s * s * y2)
        for s in shares
    ]


def _scaled(points: list[tuple[float, float]], scale: float) -> list[tuple[float, float]]:
    return [(scale * x, scale * y) for x, y in points]
