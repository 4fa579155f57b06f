"""Tests of pupil diameter, its dynamics and its drawing."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.render.camera import STUDIO_LIGHTS, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET
from kinesic.face.render.pupils import (
    CONSTRICTION_TIME,
    DILATION_TIME,
    MAX_PUPIL_DIAMETER,
    MIN_PUPIL_DIAMETER,
    Pupils,
    compute_light_on_eyes,
    compute_settled_diameter,
)

FRONT_VIEW = Camera(field_deg=12.0)


@given(st.floats(0.0, 1e12))
def test_pupil_diameter_stays_in_the_human_range_at_any_light(light: float):
    assert MIN_PUPIL_DIAMETER <= compute_settled_diameter(light) <= MAX_PUPIL_DIAMETER


def test_pupil_diameter_decreases_with_brightness():
    actual = [compute_settled_diameter(light) for light in np.geomspace(1e-3, 1e3, 50)]
    assert all(one > other for one, other in pairwise(actual))
    assert compute_settled_diameter(0.1) == pytest.approx(4.9e-3)  # 1 cd/m^2, in Moon and Spencer's formula


def test_pupils_narrow_fast_and_widen_slowly():
    assert 0.3 <= CONSTRICTION_TIME <= 0.5 < DILATION_TIME
    for previous, after, lag in ((0.01, 4.0, CONSTRICTION_TIME), (4.0, 0.01, DILATION_TIME)):
        pupils = Pupils()
        start, goal = pupils.follow(previous, 9.0), compute_settled_diameter(after)
        assert start == compute_settled_diameter(previous)
        assert pupils.follow(after, lag) == pytest.approx(goal + (start - goal) / math.e)
        assert pupils.follow(after, 20.0 * lag) == pytest.approx(goal)


def test_pupil_dynamics_are_independent_of_step_size():
    often, once = Pupils(), Pupils()
    for item in (often, once):
        item.follow(0.05, 0.0)
    for _ in range(50):
        often.follow(2.0, 0.01)
    assert often.diameter == pytest.approx(once.follow(2.0, 0.5))


def test_closed_lids_and_a_lowered_head_reduce_the_light_on_the_eyes():
    plain = compute_light_on_eyes(STUDIO_LIGHTS, {}, FRONT_VIEW)
    assert compute_light_on_eyes(STUDIO_LIGHTS, {"45": 1.0}, FRONT_VIEW) < 0.05 * plain
    assert compute_light_on_eyes(STUDIO_LIGHTS, {"L43": 1.0}, FRONT_VIEW) == pytest.approx(0.515 * plain)
    assert compute_light_on_eyes(STUDIO_LIGHTS, {}, Camera(turn=(0.0, -1.2, 0.0))) < 0.7 * plain
    assert compute_light_on_eyes(STUDIO_LIGHTS.scaled(0.25), {}, FRONT_VIEW) == pytest.approx(0.25 * plain)


def darkness(portrait: Portrait, diameter: float | None) -> tuple[float, float]:
    """Return the pupil pixel counts of the right and left eye in the picture."""
    pixels = portrait.draw({}, FRONT_VIEW, pupil=diameter).max(axis=2)
    with portrait.pipeline.geometry.context:
        eyes = portrait.pipeline.geometry.parts() == MESH_PARTS.index("eyes") + 1
    dark = eyes & (pixels < 40)
    middle = dark.shape[1] // 2
    return float(dark[:, :middle].sum()), float(dark[:, middle:].sum())


def test_both_pupils_are_drawn_with_their_diameter(drawable: None):
    """Expect equal pixel areas that grow with the squared diameter."""
    with Portrait(preset=DRAFT_PRESET, size=(512, 512)) as portrait:
        small, wide = darkness(portrait, 3e-3), darkness(portrait, 5e-3)
        assert sum(wide) / sum(small) == pytest.approx((5 / 3) ** 2, rel=0.35)
        assert wide[0] == pytest.approx(wide[1], rel=0.15)
        pixels = 512 / (2 * FRONT_VIEW.distance * math.tan(math.radians(FRONT_VIEW.field_deg) / 2))  # of a metre
        assert wide[0] == pytest.approx(math.pi * (2.5e-3 * pixels) ** 2, rel=0.35)
        usual = darkness(portrait, None)
        portrait.light(STUDIO_LIGHTS.scaled(0.5))
        assert sum(darkness(portrait, None)) > sum(usual)
