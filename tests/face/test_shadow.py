from dataclasses import replace

import numpy as np
import pytest

from kinesic.face.camera import Camera
from kinesic.face.lights import LIGHTS
from kinesic.face.portrait import Portrait
from kinesic.face.presets import DRAFT
from kinesic.face.shadow import lamp_view

SIZE = (128, 128)


def test_a_lamp_sees_the_middle_of_the_head_in_its_middle():
    towards = LIGHTS.directions()[0]
    view = lamp_view(towards, 0.85)
    middle = np.array([0.0, 0.0, -0.85, 1.0])
    np.testing.assert_allclose(view @ middle, (0.0, 0.0, 0.0, 1.0), atol=1e-12)
    nearer = view @ (middle + 0.1 * np.array([*towards, 0.0]))
    np.testing.assert_allclose(nearer[:2], 0.0, atol=1e-12)
    assert nearer[2] < 0.0  # nearer to the lamp is less deep


@pytest.mark.parametrize("yaw", [0.0, 60.0, 180.0])
def test_a_shadow_only_darkens_and_falls_on_the_neck(drawable: None, yaw: float):
    camera = Camera(yaw_deg=yaw)
    with Portrait(size=SIZE, preset=DRAFT) as bare, Portrait(size=SIZE, preset=replace(DRAFT, shadow=True)) as shaded:
        one, other = (each.draw({}, camera).astype(int) for each in (bare, shaded))
    assert (other - one).max() <= 1
    darker = (one - other).max(axis=2) > 15
    assert 0.005 < darker.mean() < 0.3
    if yaw == 0.0:
        assert darker[SIZE[1] * 3 // 4 :].sum() > 0.5 * darker.sum()  # under the chin


def test_the_forehead_does_not_shade_itself(drawable: None):
    with Portrait(size=SIZE, preset=DRAFT) as bare, Portrait(size=SIZE, preset=replace(DRAFT, shadow=True)) as shaded:
        one, other = (each.draw({}).astype(int)[34:46, 50:78] for each in (bare, shaded))
    assert np.abs(one - other).max() <= 2
