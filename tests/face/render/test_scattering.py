from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kinesic.face.render.portrait import Pixels
from kinesic.face.render.presets import NORMAL, Occlusion, Preset, Scattering

from ..conftest import Gallery

PLAIN = replace(NORMAL, scattering=None, occlusion=Occlusion(size=5), smooth=False)


@pytest.fixture(scope="module")
def drawn(gallery: Gallery) -> Callable[[Preset], Pixels]:
    """A picture of a faint smile."""

    def draw(preset: Preset) -> Pixels:
        with gallery(preset, (192, 192)) as portrait:
            return portrait.draw({"12": 0.5})

    return draw


def apart(one: Pixels, other: Pixels) -> float:
    return float(np.abs(one.astype(float) - other.astype(float)).mean())


@pytest.fixture(scope="module")
def plain(drawn) -> Pixels:
    return drawn(PLAIN)


def test_nothing_below_the_threshold_is_nothing_scattered(drawn, plain: Pixels):
    np.testing.assert_array_equal(drawn(replace(PLAIN, scattering=Scattering(threshold=-1.0))), plain)


def test_a_higher_threshold_scatters_more(drawn, plain: Pixels):
    effects = [apart(drawn(replace(PLAIN, scattering=Scattering(threshold=each))), plain) for each in (0.7, 0.93, 1.0)]
    assert 0.0 < effects[0] < effects[1] < effects[2]


def test_light_is_spread_not_lost(drawn, plain: Pixels):
    full = drawn(replace(PLAIN, scattering=Scattering(threshold=1.0)))
    assert abs(full.astype(float).mean() - plain.astype(float).mean()) < 0.5
    assert np.abs(full.astype(int) - plain.astype(int)).max() > 5
