import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from kinesic.body.choices import Variant
from kinesic.face.assets import paint
from kinesic.face.assets.chart import LEFT_RIGHT, LOW_HIGH
from kinesic.face.assets.mesh import VARIANTS
from kinesic.face.assets.paint import COMPLEXIONS, iris, skin


def at(pixels: np.ndarray, a: float, y: float) -> np.ndarray:
    """Mean colour near a place of the chart."""
    size = len(pixels)
    column = round((a - LEFT_RIGHT[0]) / (LEFT_RIGHT[1] - LEFT_RIGHT[0]) * size)
    row = round((y - LOW_HIGH[0]) / (LOW_HIGH[1] - LOW_HIGH[0]) * size)
    return pixels[row - 6 : row + 6, column - 6 : column + 6].mean(axis=(0, 1))


@pytest.mark.parametrize("variant", VARIANTS)
def test_brows_are_dark_and_lips_are_red(variant: Variant):
    complexion = COMPLEXIONS[variant]
    painted = skin(complexion)
    assert painted.min() >= 0.0
    assert painted.max() <= 1.0
    forehead = at(painted, 0.3, 0.9)
    np.testing.assert_allclose(forehead[:3], complexion.skin, rtol=0.15)
    assert forehead[3] > 0.99
    for side in (-1, 1):
        assert at(painted, side * 0.6, complexion.brow[2][1])[:3].sum() < 0.6 * forehead[:3].sum()
    lip = at(painted, 0.0, -1.2)
    assert lip[3] < 0.2
    assert lip[0] / lip[1] > 1.2 * forehead[0] / forehead[1]


def test_painting_is_the_same_every_time():
    np.testing.assert_array_equal(skin(COMPLEXIONS["male"]), skin(COMPLEXIONS["male"]))


def test_brows_are_symmetric():
    painted = skin(COMPLEXIONS["female"])
    difference = np.abs(painted - painted[:, ::-1])[700:760]
    assert difference.mean() < 0.01


def test_an_eye_has_a_pupil_in_an_iris_in_white():
    eye = iris(COMPLEXIONS["female"])
    middle = len(eye) // 2
    pupil, coloured, white = (eye[middle, middle + step].mean() for step in (0, len(eye) // 6, len(eye) // 3))
    assert pupil < 0.02 < coloured < white


@pytest.mark.parametrize("size", [0.6, 4.0])
def test_a_blur_is_that_of_the_whole_picture(size: float):
    drawn = np.zeros((60, 80))
    drawn[20:31, 70:78] = np.random.default_rng(1).uniform(0.1, 1.0, (11, 8))
    np.testing.assert_array_equal(paint._blurred(drawn, size), gaussian_filter(drawn, size))
    assert not paint._blurred(np.zeros((5, 7)), size).any()


def test_a_colour_is_mixed_in_where_there_is_some_of_it():
    under = np.random.default_rng(2).uniform(0.0, 1.0, (9, 6, 3))
    share = np.zeros((9, 6))
    share[2:5, 3] = 0.25, 1.0, 0.5
    found = under.copy()
    paint._mix(found, (0.0, 0.5, 1.0), share)
    np.testing.assert_allclose(found, under + share[..., None] * (np.array([0.0, 0.5, 1.0]) - under), atol=1e-15)
    found = under.copy()
    paint._mix(found, (0.0, 0.5, 1.0), np.zeros((9, 6)))
    assert np.array_equal(found, under)
