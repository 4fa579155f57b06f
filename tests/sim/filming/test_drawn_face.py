"""A plain face shows what action units say."""

import numpy as np
import pytest

from kinesic.body.arrays import Picture
from kinesic.sim.filming.drawn_face import LIGHT, PUPIL, SIZE, paint_face

EYES, MOUTH = slice(50, 145), slice(150, 240)  # rows


def drawn(picture: Picture, colour: tuple[int, int, int], rows: slice) -> np.ndarray:
    """(k, 2) rows and columns of the pixels of a colour."""
    return np.argwhere(np.abs(picture[rows].astype(int) - colour).max(axis=2) < 4)


@pytest.mark.parametrize("unit", ["25", "26", "27"])
def test_a_jaw_that_drops_opens_the_mouth_and_nothing_else(unit: str):
    shut, opened = paint_face({}), paint_face({unit: 0.9})
    assert len(drawn(opened, PUPIL, MOUTH)) > len(drawn(shut, PUPIL, MOUTH)) + 200
    assert (shut[:145] == opened[:145]).all()


@pytest.mark.parametrize("unit", ["43", "45"])
def test_lids_close_the_eyes_or_one_of_them(unit: str):
    both, left = paint_face({unit: 1.0}), paint_face({f"L{unit}": 1.0})
    assert len(drawn(both, PUPIL, EYES)) == 0
    seen = drawn(left, PUPIL, EYES)
    assert len(seen) > 500
    assert seen[:, 1].max() < SIZE[0] / 2, "its left eye is at our right"


@pytest.mark.parametrize(("unit", "axis", "sign"), [("61", 1, 1), ("62", 1, -1), ("63", 0, -1), ("64", 0, 1)])
def test_pupils_go_where_the_eyes_look(unit: str, axis: int, sign: int):
    ahead, aside = (drawn(paint_face(units), PUPIL, EYES).mean(axis=0) for units in ({}, {unit: 1.0}))
    assert sign * (aside - ahead)[axis] > 8


def test_corners_of_the_mouth_and_brows_rise_and_fall():
    def height(units: dict[str, float], rows: slice) -> float:
        return float(drawn(paint_face(units), LIGHT, rows)[:, 0].min())

    assert height({"12": 1.0}, MOUTH) < height({}, MOUTH) - 8
    assert height({"15": 1.0}, slice(160, 240)) > height({"12": 0.5}, slice(160, 240))
    assert (
        height({"1": 1.0, "2": 1.0}, slice(0, 145)) < height({}, slice(0, 145)) - 10 < height({"4": 1.0}, slice(0, 145))
    )


def test_any_size_is_painted():
    assert paint_face({"26": 0.5}, size=(64, 48)).shape == (48, 64, 3)
