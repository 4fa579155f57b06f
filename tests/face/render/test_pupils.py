"""Pupils follow the light that falls on the face: how wide, how slowly, and how they are drawn."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.face.assets.mesh import PARTS
from kinesic.face.render.camera import LIGHTS, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT
from kinesic.face.render.pupils import (
    CONSTRICTION,
    DILATION,
    LARGEST,
    SMALLEST,
    Pupils,
    light_on_eyes,
    settled_diameter,
)

AHEAD = Camera(field_deg=12.0)


@given(st.floats(0.0, 1e12))
def test_pupils_are_as_wide_as_a_persons(light: float):
    assert SMALLEST <= settled_diameter(light) <= LARGEST


def test_they_are_narrower_the_brighter_it_is():
    found = [settled_diameter(light) for light in np.geomspace(1e-3, 1e3, 50)]
    assert all(one > other for one, other in pairwise(found))
    assert settled_diameter(0.1) == pytest.approx(4.9e-3)  # 1 cd/m^2, in Moon and Spencer's formula


def test_they_close_within_half_a_second_and_open_slowly():
    assert 0.3 <= CONSTRICTION <= 0.5 < DILATION
    for before, after, lag in ((0.01, 4.0, CONSTRICTION), (4.0, 0.01, DILATION)):
        pupils = Pupils()
        start, goal = pupils.follow(before, 9.0), settled_diameter(after)
        assert start == settled_diameter(before)
        assert pupils.follow(after, lag) == pytest.approx(goal + (start - goal) / math.e)
        assert pupils.follow(after, 20.0 * lag) == pytest.approx(goal)


def test_how_often_they_are_looked_at_changes_nothing():
    often, once = Pupils(), Pupils()
    for each in (often, once):
        each.follow(0.05, 0.0)
    for _ in range(50):
        often.follow(2.0, 0.01)
    assert often.diameter == pytest.approx(once.follow(2.0, 0.5))


def test_lids_and_looking_down_keep_light_out():
    plain = light_on_eyes(LIGHTS, {}, AHEAD)
    assert light_on_eyes(LIGHTS, {"45": 1.0}, AHEAD) < 0.05 * plain
    assert light_on_eyes(LIGHTS, {"L43": 1.0}, AHEAD) == pytest.approx(0.515 * plain)
    assert light_on_eyes(LIGHTS, {}, Camera(turn=(0.0, -1.2, 0.0))) < 0.7 * plain
    assert light_on_eyes(LIGHTS.scaled(0.25), {}, AHEAD) == pytest.approx(0.25 * plain)


def darkness(portrait: Portrait, diameter: float | None) -> tuple[float, float]:
    """How many pixels of the right and of the left eye of the picture are a pupil's."""
    pixels = portrait.draw({}, AHEAD, pupil=diameter).max(axis=2)
    with portrait.pipeline.geometry.context:
        eyes = portrait.pipeline.geometry.parts() == PARTS.index("eyes") + 1
    dark = eyes & (pixels < 40)
    middle = dark.shape[1] // 2
    return float(dark[:, :middle].sum()), float(dark[:, middle:].sum())


def test_both_are_drawn_as_wide_as_they_are(drawable: None):
    """The area grows as the square of the diameter, on both sides alike, within the iris."""
    with Portrait(preset=DRAFT, size=(512, 512)) as portrait:
        small, wide = darkness(portrait, 3e-3), darkness(portrait, 5e-3)
        assert sum(wide) / sum(small) == pytest.approx((5 / 3) ** 2, rel=0.35)
        assert wide[0] == pytest.approx(wide[1], rel=0.15)
        pixels = 512 / (2 * AHEAD.distance * math.tan(math.radians(AHEAD.field_deg) / 2))  # of a metre
        assert wide[0] == pytest.approx(math.pi * (2.5e-3 * pixels) ** 2, rel=0.35)
        usual = darkness(portrait, None)
        portrait.light(LIGHTS.scaled(0.5))
        assert sum(darkness(portrait, None)) > sum(usual)
