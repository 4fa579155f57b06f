"""Face drawn from action units."""

import numpy as np
import pytest

from kinesic.body.arrays import Floats, Picture
from kinesic.sim.filming.drawn_face import (
    DESIGN_SIZE,
    LINE_COLOUR,
    PUPIL_COLOUR,
    SLIT_HALF_HEIGHT,
    build_strips,
    paint_face,
    read_controls,
)

EYE_ROWS = slice(60, 165)  # picture rows of the eyes
MOUTH_ROWS = slice(170, 240)  # picture rows of the mouth
BROW_ROWS = slice(0, 60)  # picture rows of the brows


def find_pixels(picture: Picture, colour: tuple[int, int, int], rows: slice) -> np.ndarray:
    """Return rows and columns (k, 2) of the pixels of a colour."""
    return np.argwhere(np.abs(picture[rows].astype(int) - colour).max(axis=2) < 4)


def count(units: dict[str, float], colour: tuple[int, int, int], rows: slice) -> int:
    return len(find_pixels(paint_face(units), colour, rows))


@pytest.mark.parametrize("unit", ["25", "26", "27"])
def test_lip_and_jaw_units_open_the_mouth_and_leave_the_upper_face_unchanged(unit: str):
    shut, opened = paint_face({}), paint_face({unit: 0.9})
    assert len(find_pixels(opened, LINE_COLOUR, MOUTH_ROWS)) > len(find_pixels(shut, LINE_COLOUR, MOUTH_ROWS)) + 200
    assert (shut[:165] == opened[:165]).all()


def test_lip_pressor_unit_closes_the_open_mouth_of_the_drawn_face():
    assert count({"26": 0.8, "24": 1.0}, LINE_COLOUR, MOUTH_ROWS) < count({}, LINE_COLOUR, MOUTH_ROWS)


@pytest.mark.parametrize("unit", ["43", "45"])
def test_eyelid_units_close_both_eyes_or_one_eye_of_the_drawn_face(unit: str):
    both, left = paint_face({unit: 1.0}), paint_face({f"L{unit}": 1.0})
    assert len(find_pixels(both, PUPIL_COLOUR, EYE_ROWS)) == 0
    lines = find_pixels(both, LINE_COLOUR, EYE_ROWS)
    assert 100 < len(lines) < 4 * SLIT_HALF_HEIGHT * 76, "a line is left"
    seen = find_pixels(left, PUPIL_COLOUR, EYE_ROWS)
    assert len(seen) > 500
    assert seen[:, 1].max() < DESIGN_SIZE[0] / 2, "its left eye is at our right"


@pytest.mark.parametrize(("unit", "axis", "sign"), [("61", 1, 1), ("62", 1, -1), ("63", 0, -1), ("64", 0, 1)])
def test_pupils_of_the_drawn_face_move_in_the_gaze_direction(unit: str, axis: int, sign: int):
    ahead, aside = (find_pixels(paint_face(units), PUPIL_COLOUR, EYE_ROWS).mean(axis=0) for units in ({}, {unit: 1.0}))
    assert sign * (aside - ahead)[axis] > 8


def test_action_units_raise_and_lower_mouth_corners_and_brows_of_the_drawn_face():
    def height(units: dict[str, float], rows: slice) -> float:
        return float(find_pixels(paint_face(units), LINE_COLOUR, rows)[:, 0].min())

    assert height({"12": 1.0}, MOUTH_ROWS) < height({}, MOUTH_ROWS) - 8
    corners = [find_pixels(paint_face(units), LINE_COLOUR, MOUTH_ROWS)[:, 0].max() for units in ({}, {"15": 1.0})]
    assert corners[1] > corners[0] + 3
    assert height({"1": 1.0, "2": 1.0}, BROW_ROWS) < height({}, BROW_ROWS) - 10 < height({"4": 1.0}, BROW_ROWS)


def test_brow_lowerer_slants_upper_lids_down_inward_and_inner_brow_raiser_slants_them_outward():
    """Measure the slant of the upper lid in the picture's left half."""

    def slant(units: dict[str, float]) -> float:
        seen = find_pixels(paint_face(units), LINE_COLOUR, slice(72, 150))
        outer, inner = (seen[(seen[:, 1] > low) & (seen[:, 1] < low + 8), 0].min() for low in (59, 117))
        return float(inner - outer)

    assert slant({"4": 1.0}) > slant({}) + 5
    assert slant({"1": 1.0}) < slant({}) - 2
    assert count({"4": 1.0}, LINE_COLOUR, EYE_ROWS) < count({}, LINE_COLOUR, EYE_ROWS)


def test_cheek_raiser_shrinks_and_upper_lid_raiser_enlarges_the_drawn_eyes():
    plain = count({}, LINE_COLOUR, EYE_ROWS)
    assert count({"6": 1.0}, LINE_COLOUR, EYE_ROWS) < 0.8 * plain
    assert count({"5": 1.0}, LINE_COLOUR, EYE_ROWS) > 1.05 * plain


def test_outline_points_of_the_drawn_face_are_linear_in_its_controls():
    """glTF scenes blend the same controls."""

    def points(controls: dict[str, float]) -> Floats:
        return np.concatenate([strip.rows.ravel() for strip in build_strips(controls)])

    one, two = read_controls({"12": 1.0, "L45": 0.7, "26": 0.5}), read_controls({"4": 0.8, "61": 1.0, "R15": 0.4})
    middle = {name: 0.25 * one[name] + 0.75 * two[name] for name in one}
    np.testing.assert_allclose(points(middle), 0.25 * points(one) + 0.75 * points(two), atol=1e-9)


def test_painted_face_has_the_requested_size():
    assert paint_face({"26": 0.5}, size=(64, 48)).shape == (48, 64, 3)
