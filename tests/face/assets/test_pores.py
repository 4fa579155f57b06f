import numpy as np
import pytest

from kinesic.face.assets.pores import OILY_AREAS, paint_creases, paint_oil, paint_pores


def test_painted_nose_and_forehead_are_oilier_than_temples_and_jaw():
    y = np.linspace(-2.0, 1.4, 200)[:, None]
    oil = paint_oil(np.linspace(0.0, 1.6, 100)[None, :], y)
    assert oil.min() >= 0.0
    assert oil.max() <= 1.0
    at_areas = [paint_oil(np.array([[a]]), np.array([[height]]))[0, 0] for a, height, _, _ in OILY_AREAS]
    temple, jaw = (paint_oil(np.array([[a]]), np.array([[height]]))[0, 0] for a, height in ((1.5, 0.3), (1.1, -1.3)))
    assert min(at_areas) > 0.99
    assert max(temple, jaw) < 0.15


def test_painted_pores_are_separate_and_deeper_on_oily_skin():
    shape = (200, 200)
    dry, oily = (paint_pores(np.full(shape, oil), np.random.default_rng(1)) for oil in (0.0, 1.0))
    assert 0.25 < np.mean(oily > 0.0) < 0.55
    assert oily.max() == pytest.approx(1.0)
    np.testing.assert_allclose(dry, 0.45 * oily)
    shifted = np.corrcoef(oily[:, :-4].ravel(), oily[:, 4:].ravel())[0, 1]
    assert abs(shifted) < 0.05  # four pixels apart, pores are unrelated


def test_painted_lip_creases_are_vertical():
    creases = paint_creases(160, 160, np.random.default_rng(1))
    assert 0.0 <= creases.min() < creases.max() <= 1.0
    assert np.abs(np.diff(creases, axis=1)).mean() > 4.0 * np.abs(np.diff(creases, axis=0)).mean()
