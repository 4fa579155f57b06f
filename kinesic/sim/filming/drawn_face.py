"""Face drawn from action units: eyes with lids, brows and a mouth.

Each shape is a strip between two rows of points that depend linearly on a few controls, so that films, pages and glTF
scenes show the same face: a film fills the strips, a glTF scene turns each control into a morph target.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, Picture, sealed
from kinesic.files.late_pillow import Image, ImageDraw

Colour = tuple[int, int, int]

BACKGROUND_COLOUR: Colour = (12, 18, 30)  # RGB colour behind the drawn face, and of the lids
LINE_COLOUR: Colour = (196, 240, 255)  # RGB colour of eyes, brows and the mouth
PUPIL_COLOUR: Colour = (16, 34, 62)  # RGB colour of pupils
GLINT_COLOUR: Colour = (255, 255, 255)  # RGB colour of the reflection in a pupil
SUPERSAMPLING_FACTOR = 2  # painted pixels per picture pixel along each side
DESIGN_SIZE = (320, 240)  # [pixels] width and height of the picture in which all lengths of this file are given
SCREEN_SIZE = (240, 180)  # [pixels] size of the picture on a head's screen, which is about 150 pixels wide in a film
EYE_HALF_AXES = (35.0, 45.0)  # [pixels] horizontal and vertical half axis of an open eye
EYE_TOP_DISTANCE = 106.0  # [pixels] distance of the eyes' centres from the top of the picture
EYE_MIDLINE_DISTANCE = 68.0  # [pixels] distance of an eye's centre from the midline
PUPIL_HALF_AXES = (18.0, 23.0)  # [pixels] horizontal and vertical half axis of a pupil
PUPIL_TRAVEL = (13.0, 15.0)  # [pixels] largest horizontal and vertical motion of a pupil
GLINT_OFFSET = (-6.0, -0.42)  # reflection's offset from the pupil's centre: [pixels] right, [pupil heights] down
GLINT_HALF_AXES = (5.5, 0.28)  # half axes of the reflection: [pixels] horizontally, and pupil heights vertically
LID_MARGIN = 3.0  # [pixels] gap between the edge of an open lid and the eye's outline
LID_DEPTH = 14.0  # [pixels] extent of each lid above or below the open eye
LID_TILT = 17.0  # [pixels] lowering of the upper lid's inner end, and rise of the outer, in a frown
SLIT_HALF_HEIGHT = 4.0  # [pixels] half the thickness of a closed eye's line
CLOSED_SAG = 9.0  # [pixels] sag of a closed eye's line in its middle
SMILING_SAG = -20.0  # [pixels] change of `CLOSED_SAG` in a full smile
BROW_HEIGHT = 62.0  # [pixels] height of a relaxed brow above the eye's centre
BROW_LIFT = 19.0  # [pixels] largest vertical motion of a brow
BROW_HALF_LENGTH = 32.0  # [pixels] half the length of a brow
BROW_HALF_WIDTH = 6.0  # [pixels] half the thickness of a brow
BROW_ARCH = 6.0  # [pixels] height of a brow's middle above its ends
BROW_FROWN_SHIFT = 6.0  # [pixels] motion of the brows towards the midline in a full frown
MOUTH_TOP_DISTANCE = 188.0  # [pixels] distance of the mouth corners from the top of the picture
MOUTH_SAG = 5.0  # [pixels] depth of a relaxed mouth's middle below its corners
MOUTH_HALF_WIDTH = 46.0  # [pixels] distance of a relaxed mouth corner from the midline
MOUTH_HALF_THICKNESS = 6.0  # [pixels] half the thickness of a closed mouth
MOUTH_DROP = 46.0  # [pixels] height of the mouth opening at full jaw drop (AU 26)
STRIP_POINTS = 25  # number of points of each edge, upper and lower, of a strip
EYE_STRIPS = 6  # number of overlaid strips that draw one eye with its lids and brow
FACE_SIDES: tuple[tuple[str, float], ...] = (("R", -1.0), ("L", 1.0))  # (side, sign of x), with R left in the picture


@dataclass(frozen=True, eq=False)
class FaceStrip:
    """Shape of one colour between an upper and a lower polyline."""

    colour: Colour
    rows: Floats  # (2, k, 2) [pixels] to the right and down, in a picture of DESIGN_SIZE


def paint_face(units: Mapping[str, float], *, size: tuple[int, int] = DESIGN_SIZE) -> Picture:
    """Draw a face that shows the given action units.

    Args:
        units: Action unit -> 0..1, as in `Command.face`.
        size: Width and height [pixels].
    """
    picture = Image.new("RGB", (SUPERSAMPLING_FACTOR * size[0], SUPERSAMPLING_FACTOR * size[1]), BACKGROUND_COLOUR)
    pen = ImageDraw.Draw(picture)
    scale = SUPERSAMPLING_FACTOR * np.array(size) / DESIGN_SIZE
    for strip in build_strips(read_controls(units)):
        outline = np.concatenate([strip.rows[0], strip.rows[1, ::-1]]) * scale
        pen.polygon(outline.ravel().tolist(), fill=strip.colour)
    return np.asarray(picture.reduce(SUPERSAMPLING_FACTOR))


def shown_intensity(units: Mapping[str, float], number: int, side: str = "") -> float:
    """Return the intensity of an action unit on a side, 0..1."""
    return max(units.get(str(number), 0.0), units.get(f"{side}{number}", 0.0) if side else 0.0)


def read_controls(units: Mapping[str, float]) -> dict[str, float]:
    """Convert action units to face shape parameters [pixels], input of `build_strips`."""
    controls: dict[str, float] = {}
    for side, sign in FACE_SIDES:
        controls |= {f"{side} {name}": value for name, value in _read_eye(units, side, sign).items()}
    return controls | _read_mouth(units)


def _read_eye(units: Mapping[str, float], side: str, sign: float) -> dict[str, float]:
    def shown(number: int) -> float:
        return shown_intensity(units, number, side)

    closed = max(shown(number) for number in (43, 45, 46))
    smile = min(max(shown(6), 0.45 * shown(12)), 1.0)
    frown, sorrow = shown(4) * (1.0 - 0.7 * shown(1)), shown(1) * (1.0 - shown(2))
    height = EYE_HALF_AXES[1] * (1.0 + 0.15 * shown(5))
    upper = (height + LID_MARGIN) * (1.0 - 0.25 * shown(7)) - 0.35 * EYE_HALF_AXES[1] * frown
    lower = (height + LID_MARGIN) * (1.0 - 0.3 * shown(7) - 0.7 * smile)
    sag = CLOSED_SAG + SMILING_SAG * smile
    gaze = shown_intensity(units, 61) - shown_intensity(units, 62) - sign * 0.4 * shown_intensity(units, 66)
    rise = shown_intensity(units, 63) - shown_intensity(units, 64)
    return {
        "eye height": height,
        "pupil right": PUPIL_TRAVEL[0] * gaze,
        "pupil up": PUPIL_TRAVEL[1] * rise * (1.0 - closed),
        "pupil height": PUPIL_HALF_AXES[1] * (1.0 - closed),
        "upper lid": (1.0 - closed) * upper + closed * (SLIT_HALF_HEIGHT - sag),
        "lower lid": (1.0 - closed) * lower + closed * (SLIT_HALF_HEIGHT + sag),
        "lid tilt": (1.0 - closed) * LID_TILT * (frown - 0.7 * sorrow),
        "brow inner": BROW_LIFT * (shown(1) - 0.9 * shown(4) * (1.0 - 0.8 * shown(1))),
        "brow outer": BROW_LIFT * (shown(2) - 0.2 * shown(4) - 0.25 * sorrow),
        "brow shift": BROW_FROWN_SHIFT * shown(4),
    }


def _read_mouth(units: Mapping[str, float]) -> dict[str, float]:
    def shown(number: int) -> float:
        return max(shown_intensity(units, number, side) for side, _ in FACE_SIDES)

    narrow = max(shown(18), 0.7 * shown(22), 0.4 * shown(23), 0.25 * shown(24))
    opening = max(0.3 * shown(25), shown(26), 1.3 * shown(27), 0.3 * shown(22))
    pressed = max(shown(24), shown(28), 0.7 * shown(23))
    opening *= 1.0 - max(shown(24), shown(28))
    controls: dict[str, float] = {}
    for side, _ in FACE_SIDES:
        smile, depressed, stretch = (shown_intensity(units, number, side) for number in (12, 15, 20))
        dimple = shown_intensity(units, 14, side)
        controls[f"{side} corner out"] = MOUTH_HALF_WIDTH * (
            1.0 + 0.3 * smile + 0.2 * stretch + 0.12 * dimple - 0.5 * narrow
        )
        controls[f"{side} corner up"] = 17.0 * smile + 5.0 * dimple - 15.0 * depressed
    bend = MOUTH_SAG + 4.0 * shown(12) - 9.0 * shown(15) - 6.0 * shown(17)
    return controls | {
        "upper lip": -bend + (0.22 + 0.2 * narrow) * MOUTH_DROP * opening + 7.0 * max(shown(10), 0.6 * shown(9)),
        "lower lip": bend + (0.78 - 0.1 * narrow) * MOUTH_DROP * opening + 6.0 * shown(16) - 4.0 * shown(10),
        "lip thickness": MOUTH_HALF_THICKNESS * (1.0 - 0.35 * pressed),
    }


def build_strips(controls: Mapping[str, float]) -> tuple[FaceStrip, ...]:
    """Return the coloured shapes of a face, back to front."""
    strips: list[FaceStrip] = []
    for side, sign in FACE_SIDES:
        own = {name[2:]: value for name, value in controls.items() if name.startswith(f"{side} ")}
        strips += _build_eye(own, sign)
    return (*strips, _build_mouth(controls))


def _build_eye(controls: Mapping[str, float], sign: float) -> list[FaceStrip]:
    """Return the shapes of one side's eye, pupil, lids and brow."""
    turn = np.linspace(np.pi, 0.0, STRIP_POINTS)
    cosine, sine = np.cos(turn), np.sin(turn)
    x, y = DESIGN_SIZE[0] / 2 + sign * EYE_MIDLINE_DISTANCE, EYE_TOP_DISTANCE
    pupil_x, pupil_y, tall = x + controls["pupil right"], y - controls["pupil up"], controls["pupil height"]

    def oval(colour: Colour, across: float, down: float, half_width: float, half_height: float) -> FaceStrip:
        columns = across + half_width * cosine
        return _make_strip(colour, columns, down - half_height * sine, columns, down + half_height * sine)

    lid_x = x + (EYE_HALF_AXES[0] + LID_MARGIN) * cosine
    beyond = EYE_HALF_AXES[1] + LID_DEPTH
    upper = y - controls["upper lid"] * sine - sign * controls["lid tilt"] * cosine
    lower = y + controls["lower lid"] * sine
    along = np.linspace(-1.0, 1.0, STRIP_POINTS)  # from the outer to the inner end on the right side of the face
    inward = -sign * along
    lift = 0.5 * ((1.0 + inward) * controls["brow inner"] + (1.0 - inward) * controls["brow outer"])
    middle = y - BROW_HEIGHT - lift - BROW_ARCH * (1.0 - along**2)
    thick = BROW_HALF_WIDTH * _round_ends(along)
    brow_x = x + BROW_HALF_LENGTH * along - sign * controls["brow shift"]
    return [
        oval(LINE_COLOUR, x, y, EYE_HALF_AXES[0], controls["eye height"]),
        oval(PUPIL_COLOUR, pupil_x, pupil_y, PUPIL_HALF_AXES[0], tall),
        oval(
            GLINT_COLOUR,
            pupil_x + GLINT_OFFSET[0],
            pupil_y + GLINT_OFFSET[1] * tall,
            GLINT_HALF_AXES[0],
            GLINT_HALF_AXES[1] * tall,
        ),
        _make_strip(BACKGROUND_COLOUR, lid_x, np.full(STRIP_POINTS, y - beyond), lid_x, upper),
        _make_strip(BACKGROUND_COLOUR, lid_x, lower, lid_x, np.full(STRIP_POINTS, y + beyond)),
        _make_strip(LINE_COLOUR, brow_x, middle - thick, brow_x, middle + thick),
    ]


def _build_mouth(controls: Mapping[str, float]) -> FaceStrip:
    """Return the shape of the mouth, a line if it is closed."""
    along = np.linspace(0.0, 1.0, STRIP_POINTS)
    left, right = (
        np.array(
            [
                DESIGN_SIZE[0] / 2 + sign * controls[f"{side} corner out"],
                MOUTH_TOP_DISTANCE - controls[f"{side} corner up"],
            ]
        )
        for side, sign in FACE_SIDES
    )
    columns = left[0] + along * (right[0] - left[0])
    straight = left[1] + along * (right[1] - left[1])
    bulge = 4.0 * along * (1.0 - along)  # of a parabola through both corners
    level = 0.5 * (left[1] + right[1])
    thick = controls["lip thickness"] * _round_ends(2.0 * along - 1.0)
    upper, lower = (
        straight + bulge * (MOUTH_TOP_DISTANCE + sign * controls[lip] - level)
        for lip, sign in (("upper lip", -1.0), ("lower lip", 1.0))
    )
    return _make_strip(LINE_COLOUR, columns, upper - thick, columns, lower + thick)


def _round_ends(along: Floats) -> Floats:
    """Return relative widths of a round-ended line at positions -1..1."""
    return np.asarray(np.sqrt(1.0 - np.abs(along) ** 8))


def _make_strip(colour: Colour, upper_x: Floats, upper_y: Floats, lower_x: Floats, lower_y: Floats) -> FaceStrip:
    return FaceStrip(
        colour, sealed(np.stack([np.stack([upper_x, upper_y], axis=1), np.stack([lower_x, lower_y], axis=1)]))
    )
