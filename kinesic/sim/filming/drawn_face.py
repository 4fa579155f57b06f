"""A plain face drawn from action units: eyes, brows and a mouth.

For heads with a screen but without a rendered face.
"""

from collections.abc import Mapping

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture

BACKGROUND_COLOUR = (20, 26, 38)  # RGB colour behind the drawn face
LINE_COLOUR = (214, 240, 250)  # RGB colour of eyes, brows and the mouth's outline
PUPIL_COLOUR = (14, 20, 32)  # RGB colour of pupils and the open mouth
SUPERSAMPLING_FACTOR = 2  # painted pixels per picture pixel along each side
DESIGN_SIZE = (320, 240)  # [pixels] width and height to which the lengths below refer
SCREEN_SIZE = (240, 180)  # [pixels] picture on a head's screen, which is about 100 pixels wide in a film
EYE_HALF_AXES = (30.0, 38.0)  # [pixels] horizontal and vertical half axis of an open eye
EYE_TOP_DISTANCE = 98.0  # [pixels] distance of the eyes' centres from the top of the picture
EYE_MIDLINE_DISTANCE = 68.0  # [pixels] distance of an eye's centre from the midline
PUPIL_HALF_AXES = (16.0, 20.0)  # [pixels] horizontal and vertical half axis of a pupil
PUPIL_TRAVEL = (12.0, 15.0)  # [pixels] largest horizontal and vertical motion of a pupil
BROW_HEIGHT = 46.0  # [pixels] height of a relaxed brow above the eye's centre
BROW_LIFT = 18.0  # [pixels] largest vertical motion of a brow
MOUTH_TOP_DISTANCE = 184.0  # [pixels] distance of the mouth corners from the top of the picture
MOUTH_HALF_WIDTH = 46.0  # [pixels] distance of a relaxed mouth corner from the midline


def paint_face(units: Mapping[str, float], *, size: tuple[int, int] = DESIGN_SIZE) -> Picture:
    """Draw a face that shows the given action units.

    Args:
        units: Action unit -> 0..1, as in `Command.face`.
        size: Width and height [pixels].
    """
    picture = Image.new("RGB", (SUPERSAMPLING_FACTOR * size[0], SUPERSAMPLING_FACTOR * size[1]), BACKGROUND_COLOUR)
    pen, scale = ImageDraw.Draw(picture), SUPERSAMPLING_FACTOR * size[0] / DESIGN_SIZE[0]
    for side, sign in (("R", -1.0), ("L", 1.0)):  # the face's right side is on the left of the picture
        _paint_eye(pen, scale, units, side, sign)
    _paint_mouth(pen, scale, units)
    return np.asarray(picture.reduce(SUPERSAMPLING_FACTOR))


def shown_intensity(units: Mapping[str, float], number: int, side: str = "") -> float:
    """Return the intensity of an action unit on a side, 0..1."""
    return max(units.get(str(number), 0.0), units.get(f"{side}{number}", 0.0) if side else 0.0)


def _paint_eye(pen: ImageDraw.ImageDraw, scale: float, units: Mapping[str, float], side: str, sign: float) -> None:
    closed = max(shown_intensity(units, number, side) for number in (43, 45, 46))
    openness = max(1.0 - closed - 0.25 * shown_intensity(units, 7, side) - 0.2 * shown_intensity(units, 6, side), 0.0)
    half_height = EYE_HALF_AXES[1] * openness * (1.0 + 0.2 * shown_intensity(units, 5, side))
    x, y = DESIGN_SIZE[0] / 2 + sign * EYE_MIDLINE_DISTANCE, EYE_TOP_DISTANCE
    if half_height < 3.0:
        pen.line(
            _scale([(x - EYE_HALF_AXES[0], y), (x + EYE_HALF_AXES[0], y)], scale),
            fill=LINE_COLOUR,
            width=round(5 * scale),
        )
    else:
        pen.ellipse(
            _scale([(x - EYE_HALF_AXES[0], y - half_height), (x + EYE_HALF_AXES[0], y + half_height)], scale),
            fill=LINE_COLOUR,
        )
        gaze_x = shown_intensity(units, 61) - shown_intensity(units, 62) - sign * 0.4 * shown_intensity(units, 66)
        px, py = (
            x + PUPIL_TRAVEL[0] * gaze_x,
            y + PUPIL_TRAVEL[1] * (shown_intensity(units, 64) - shown_intensity(units, 63)) * openness,
        )
        pupil_height = min(PUPIL_HALF_AXES[1], 0.9 * half_height)
        pen.ellipse(
            _scale([(px - PUPIL_HALF_AXES[0], py - pupil_height), (px + PUPIL_HALF_AXES[0], py + pupil_height)], scale),
            fill=PUPIL_COLOUR,
        )
    frown = 0.6 * shown_intensity(units, 4, side)
    inner, outer = (
        BROW_LIFT * (shown_intensity(units, number, side) - frown * weight) for number, weight in ((1, 1.0), (2, 0.4))
    )
    ends = [(x - sign * EYE_HALF_AXES[0], y - BROW_HEIGHT - inner), (x, y - BROW_HEIGHT - 5 - (inner + outer) / 2)]
    ends.append((x + sign * EYE_HALF_AXES[0], y - BROW_HEIGHT - outer))
    pen.line(_scale(ends, scale), fill=LINE_COLOUR, width=round(7 * scale), joint="curve")


def _paint_mouth(pen: ImageDraw.ImageDraw, scale: float, units: Mapping[str, float]) -> None:
    narrow = max(shown_intensity(units, 18), 0.7 * shown_intensity(units, 22), 0.4 * shown_intensity(units, 23))
    opening = max(
        0.35 * shown_intensity(units, 25),
        shown_intensity(units, 26),
        1.3 * shown_intensity(units, 27),
        0.25 * shown_intensity(units, 22),
    )
    opening *= 1.0 - max(shown_intensity(units, 24), shown_intensity(units, 28))
    corners = {}
    for side, sign in (("R", -1.0), ("L", 1.0)):
        smile, frown_mouth, stretch = (shown_intensity(units, number, side) for number in (12, 15, 20))
        half = MOUTH_HALF_WIDTH * (1.0 + 0.25 * smile + 0.2 * stretch - 0.5 * narrow)
        corners[sign] = (DESIGN_SIZE[0] / 2 + sign * half, MOUTH_TOP_DISTANCE - 18.0 * smile + 14.0 * frown_mouth)
    drop, middle = 42.0 * opening, MOUTH_TOP_DISTANCE + 4.0 - 4.0 * shown_intensity(units, 17)
    upper, lower = _fit_arc(corners, middle - 0.2 * drop), _fit_arc(corners, middle + 0.8 * drop)
    pen.polygon(_scale([*upper, *reversed(lower)], scale), fill=PUPIL_COLOUR)
    pen.line(
        _scale([*upper, *reversed(lower), upper[0]], scale), fill=LINE_COLOUR, width=round(6 * scale), joint="curve"
    )


def _fit_arc(corners: Mapping[float, tuple[float, float]], middle: float) -> list[tuple[float, float]]:
    """Return points on a parabola through both mouth corners and the middle."""
    (x0, y0), (x2, y2) = corners[-1.0], corners[1.0]
    x1, y1 = (x0 + x2) / 2, 2 * middle - (y0 + y2) / 2
    parameters = [k / 16 for k in range(17)]
    return [
        ((1 - s) ** 2 * x0 + 2 * s * (1 - s) * x1 + s * s * x2, (1 - s) ** 2 * y0 + 2 * s * (1 - s) * y1 + s * s * y2)
        for s in parameters
    ]


def _scale(points: list[tuple[float, float]], scale: float) -> list[tuple[float, float]]:
    return [(scale * x, scale * y) for x, y in points]
