"""Scattering, depth of field, and edges."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from kinesic.body.arrays import Picture
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import FRONT, Camera
from kinesic.face.render.presets import DRAFT, NORMAL, Focus, Occlusion, Preset, Scattering

from ..conftest import Gallery

SIZE = (256, 256)
ASIDE = Camera(yaw_deg=60.0)
PLAIN = replace(NORMAL, scattering=None, occlusion=Occlusion(size=5), smooth=False)


@pytest.fixture
def drawn(gallery: Gallery) -> Callable[..., NDArray[np.int64]]:
    """A picture of the face at rest."""

    def draw(preset: Preset, camera: Camera = ASIDE, size: tuple[int, int] = SIZE) -> NDArray[np.int64]:
        with gallery(preset, size) as portrait:
            return portrait.draw({}, camera).astype(np.int64)

    return draw


def sharpness(pixels: NDArray[np.int64]) -> float:
    """How much neighbours differ."""
    return float(np.abs(np.diff(pixels, axis=1)).mean())


def test_what_is_in_focus_stays_and_what_is_behind_is_blurred(drawn):
    plain, blurred = (drawn(replace(NORMAL, focus=focus), FRONT) for focus in (None, Focus(circle=0.3)))
    eyes, ear = np.s_[90:112, 85:170], np.s_[95:145, 55:74]
    assert np.abs(blurred - plain)[eyes].mean() < 1.0
    assert sharpness(blurred[ear]) < 0.9 * sharpness(plain[ear])
    assert abs(blurred.mean() - plain.mean()) < 2.0


def test_what_is_sharp_does_not_bleed_into_the_backdrop(drawn):
    plain, blurred = (drawn(replace(DRAFT, focus=focus), FRONT) for focus in (None, Focus(circle=0.12)))
    apart = np.abs(blurred - plain).max(axis=2)
    assert apart[30:200, :30].max() <= 2  # well beside the head, but within the circle of the shoulders


def test_a_wider_circle_blurs_more_and_none_is_no_change(drawn):
    plain = drawn(DRAFT)
    apart = [float(np.abs(drawn(replace(DRAFT, focus=Focus(circle=c))) - plain).mean()) for c in (0.0, 0.03, 0.12)]
    assert apart[0] < 0.01
    assert apart[0] < apart[1] < apart[2]


def test_what_is_sharp_is_selected(drawn):
    """A plane through the nearer eye is the usual one; one through the ear blurs the eyes and not the ear."""
    usual, eyes, ear = (
        drawn(replace(NORMAL, focus=Focus(circle=0.3, plane=plane)), FRONT) for plane in (None, 0.78, 0.87)
    )
    at_eyes, at_ear = np.s_[90:112, 85:170], np.s_[95:145, 55:74]
    assert np.abs(eyes - usual)[at_eyes].mean() < 1.0
    assert sharpness(ear[at_eyes]) < 0.9 * sharpness(usual[at_eyes])
    assert sharpness(ear[at_ear]) > 1.1 * sharpness(usual[at_ear])


def test_an_interval_that_holds_the_head_leaves_it_sharp(drawn):
    plain, kept = (drawn(replace(DRAFT, focus=focus), FRONT) for focus in (None, Focus(plane=0.85, within=0.4)))
    assert np.abs(kept - plain)[60:160, 95:160].max() <= 1


def test_smooth_edges_change_edges_alone(drawn):
    plain, smoothed = drawn(DRAFT), drawn(replace(DRAFT, smooth=True))
    changed = np.abs(smoothed - plain).max(axis=2) > 0
    steep = np.maximum(np.abs(np.diff(plain, axis=0, prepend=0)), np.abs(np.diff(plain, axis=1, prepend=0))).max(axis=2)
    assert 0.001 < changed.mean() < 0.15
    assert steep[changed].mean() > 4 * steep[~changed].mean()


def test_more_samples_are_the_mean_of_a_larger_picture(drawn):
    mean = drawn(DRAFT, size=(512, 512)).astype(np.float64).reshape(256, 2, 256, 2, 3).mean(axis=(1, 3))
    assert np.abs(drawn(replace(DRAFT, samples=2)) - mean).max() <= 1.0


@pytest.fixture(scope="module")
def smiling(gallery: Gallery) -> Callable[[Preset], Picture]:
    """A picture of a faint smile."""

    def draw(preset: Preset) -> Picture:
        with gallery(preset, (192, 192)) as portrait:
            return portrait.draw({"12": 0.5})

    return draw


def apart(one: Picture, other: Picture) -> float:
    return float(np.abs(one.astype(float) - other.astype(float)).mean())


@pytest.fixture(scope="module")
def unscattered(smiling) -> Picture:
    return smiling(PLAIN)


def test_nothing_below_the_threshold_is_nothing_scattered(smiling, unscattered: Picture):
    np.testing.assert_array_equal(smiling(replace(PLAIN, scattering=Scattering(threshold=-1.0))), unscattered)


def test_a_higher_threshold_scatters_more(smiling, unscattered: Picture):
    effects = [
        apart(smiling(replace(PLAIN, scattering=Scattering(threshold=each))), unscattered) for each in (0.7, 0.93, 1.0)
    ]
    assert 0.0 < effects[0] < effects[1] < effects[2]


def test_light_is_spread_not_lost(smiling, unscattered: Picture):
    full = smiling(replace(PLAIN, scattering=Scattering(threshold=1.0)))
    assert abs(full.astype(float).mean() - unscattered.astype(float).mean()) < 0.5
    assert np.abs(full.astype(int) - unscattered.astype(int)).max() > 5


EVERYWHERE = Scattering(threshold=1.0, steps=5)


def test_levels_of_scattering_are_between_nothing_and_all(smiling, unscattered: Picture):
    full, levels, one = (
        smiling(replace(PLAIN, scattering=each))
        for each in (EVERYWHERE, replace(EVERYWHERE, levels=3), replace(EVERYWHERE, levels=1))
    )
    np.testing.assert_array_equal(full, one)
    assert 0.2 * apart(full, unscattered) < apart(levels, unscattered) < 0.99 * apart(full, unscattered)
    assert apart(levels, full) > 0.0


def test_the_more_occluded_the_more_samples(gallery: Gallery):
    """Figure 5.2: the level that is kept beside each pixel of even skin falls as openness rises."""
    preset = replace(PLAIN, scattering=replace(EVERYWHERE, levels=3), coarse=1)
    with gallery(preset, (192, 192)) as portrait:
        portrait.draw({})
        pipeline = portrait.pipeline
        blurred = pipeline.occlusion.blurs[-1].target.read(0)[..., 0]
        level = np.rint(3 * pipeline.scatter.levels() / 255.0)
    assert set(np.unique(level)) == {0.0, 1.0, 2.0, 3.0}
    means = [blurred[level == each].mean() for each in (1.0, 2.0)]
    assert means[0] > means[1] + 0.05


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ({"levels": 4}, "light spreads in 4 levels; with 3 samples there are 1 to 3"),
        ({"levels": 2, "threshold": 0.5}, "all levels at openness 0.6; it must be below the threshold 0.5"),
    ],
)
def test_levels_that_cannot_be_told_apart_are_refused(told: dict[str, float], says: str):
    with pytest.raises(DisplayError, match=says):
        Scattering(**told)
