"""Plain face drawn from action units."""

import numpy as np
import pytest

from kinesic.body.arrays import Picture
from kinesic.sim.filming.drawn_face import DESIGN_SIZE, LINE_COLOUR, PUPIL_COLOUR, paint_face

EYE_ROWS = slice(50, 145)  # picture rows of the eyes
MOUTH_ROWS = slice(150, 240)  # picture rows of the mouth


def find_pixels(picture: Picture, colour: tuple[int, int, int], rows: slice) -> np.ndarray:
    """Return rows and columns (k, 2) of the pixels of a colour."""
    return np.argwhere(np.abs(picture[rows].astype(int) - colour).max(axis=2) < 4)


@pytest.mark.parametrize("unit", ["25", "26", "27"])
def test_jaw_drop_opens_only_the_mouth(unit: str):
    shut, opened = paint_face({}), paint_face({unit: 0.9})
    assert len(find_pixels(opened, PUPIL_COLOUR, MOUTH_ROWS)) > len(find_pixels(shut, PUPIL_COLOUR, MOUTH_ROWS)) + 200
    assert (shut[:145] == opened[:145]).all()


@pytest.mark.parametrize("unit", ["43", "45"])
def test_eyelid_units_close_both_eyes_or_one(unit: str):
    both, left = paint_face({unit: 1.0}), paint_face({f"L{unit}": 1.0})
    assert len(find_pixels(both, PUPIL_COLOUR, EYE_ROWS)) == 0
    seen = find_pixels(left, PUPIL_COLOUR, EYE_ROWS)
    assert len(seen) > 500
    assert seen[:, 1].max() < DESIGN_SIZE[0] / 2, "its left eye is at our right"


@pytest.mark.parametrize(("unit", "axis", "sign"), [("61", 1, 1), ("62", 1, -1), ("63", 0, -1), ("64", 0, 1)])
def test_pupils_move_in_the_gaze_direction(unit: str, axis: int, sign: int):
    ahead, aside = (find_pixels(paint_face(units), PUPIL_COLOUR, EYE_ROWS).mean(axis=0) for units in ({}, {unit: 1.0}))
    assert sign * (aside - ahead)[axis] > 8


def test_action_units_raise_and_lower_mouth_corners_and_brows():
    def height(units: dict[str, float], rows: slice) -> float:
        return float(find_pixels(paint_face(units), LINE_COLOUR, rows)[:, 0].min())

    assert height({"12": 1.0}, MOUTH_ROWS) < height({}, MOUTH_ROWS) - 8
    assert height({"15": 1.0}, slice(160, 240)) > height({"12": 0.5}, slice(160, 240))
    assert (
        height({"1": 1.0, "2": 1.0}, slice(0, 145)) < height({}, slice(0, 145)) - 10 < height({"4": 1.0}, slice(0, 145))
    )


def test_face_is_painted_at_any_size():
    assert paint_face({"26": 0.5}, size=(64, 48)).shape == (48, 64, 3)
