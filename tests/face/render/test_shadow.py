from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.render.camera import FRONT_CAMERA, STUDIO_LIGHTS, Camera
from kinesic.face.render.presets import DRAFT_PRESET, Preset, Shadow
from kinesic.face.render.shadow import compute_lamp_view

from ..conftest import Gallery

PICTURE_SIZE = (128, 128)
SHADOW_PRESET = replace(DRAFT_PRESET, shadow=Shadow(), coarse=1)


@pytest.fixture
def drawn(gallery: Gallery) -> Callable[..., NDArray[np.int64]]:
    """Function that draws the face at rest."""

    def draw(preset: Preset, camera: Camera = FRONT_CAMERA) -> NDArray[np.int64]:
        with gallery(preset, PICTURE_SIZE) as portrait:
            return portrait.draw({}, camera).astype(np.int64)

    return draw


@pytest.fixture
def reached(gallery: Gallery) -> Callable[..., tuple[Floats, NDArray[np.intp]]]:
    """Function that returns the key light and the part at every pixel.

    Shapes are (height, width, 3), 0..1, and (height, width), 1 for skin.
    """

    def reach(shadow: Shadow, *, eyeshade: bool = False) -> tuple[Floats, NDArray[np.intp]]:
        with gallery(replace(SHADOW_PRESET, shadow=shadow, eyeshade=eyeshade), (256, 256)) as portrait:
            portrait.draw({})
            seen = portrait.pipeline.geometry.parts()
            pipeline = portrait.pipeline
            texture = pipeline.draw_received_light(FRONT_CAMERA, pipeline.draw_openness(FRONT_CAMERA))
            light = np.frombuffer(texture.read(), np.float32).reshape(256, 256, 4)[::-1, :, :3]
            return light.astype(np.float64), seen

    return reach


def test_shadow_projection_of_a_lamp_is_centred_on_the_head():
    towards = STUDIO_LIGHTS.directions()[0]
    view = compute_lamp_view(towards, 0.85, Shadow())
    middle = np.array([0.0, 0.0, -0.85, 1.0])
    np.testing.assert_allclose(view @ middle, (0.0, 0.0, 0.0, 1.0), atol=1e-12)
    nearer = view @ (middle + 0.1 * np.array([*towards, 0.0]))
    np.testing.assert_allclose(nearer[:2], 0.0, atol=1e-12)
    assert nearer[2] < 0.0  # nearer to the lamp is less deep


@pytest.mark.parametrize("coarse", [1, 2])
@pytest.mark.parametrize("yaw", [0.0, 60.0, 180.0])
def test_shadow_darkens_the_picture_mainly_on_the_neck_and_brightens_no_pixel(drawn, yaw: float, coarse: int):
    camera = Camera(yaw_deg=yaw)
    one, other = drawn(DRAFT_PRESET, camera), drawn(replace(SHADOW_PRESET, coarse=coarse), camera)
    assert (other - one).max() <= 1
    darker = (one - other).max(axis=2) > 15
    assert 0.005 < darker.mean() < 0.3
    if yaw == 0.0:
        assert darker[PICTURE_SIZE[1] * 3 // 4 :].sum() > 0.5 * darker.sum()  # under the chin


def test_drawn_forehead_has_no_self_shadow(drawn):
    one, other = (drawn(preset)[34:46, 50:78] for preset in (DRAFT_PRESET, SHADOW_PRESET))
    assert np.abs(one - other).max() <= 2


def test_wider_lamp_widens_the_penumbra_of_face_shadows(reached):
    partly = [
        float(np.mean((light > 0.1) & (light < 0.9))) for light in (reached(Shadow(lamp=w))[0] for w in (0.02, 0.3))
    ]
    assert partly[1] > 1.5 * partly[0] > 0.0


def test_penumbra_of_a_shadow_grows_with_the_distance_of_the_blocking_part(reached):
    """Compare the shadow's edge width at the jaw and farther away."""
    light, seen = reached(Shadow(lamp=0.3))
    below = (seen == 1) & (np.arange(256)[:, None] > 196)
    partly = ((light[..., 0] > 0.1) & (light[..., 0] < 0.9) & below).sum(axis=0)
    at_the_jaw, far_from_it = partly[102:109], partly[125:140]
    assert at_the_jaw.min() > 0
    assert np.median(far_from_it) > 2 * np.median(at_the_jaw)


def test_light_through_an_eyeshade_is_tinted(reached):
    plain, _ = reached(Shadow())
    uncoloured, seen = reached(Shadow(), eyeshade=True)
    coloured, _ = reached(Shadow(coloured=True), eyeshade=True)
    skin = seen == 1
    np.testing.assert_allclose(uncoloured[skin], plain[skin], atol=1 / 255)  # translucent layers have their own map
    red, green, blue = coloured[skin].T
    tinted = green - red > 0.1
    assert 0.02 < tinted.mean() < 0.5
    assert np.all(green[tinted] >= blue[tinted])
    untouched = np.abs(coloured - plain)[skin].max(axis=1) < 1 / 255
    assert untouched.mean() > 0.3
    forehead = skin & (np.arange(256)[:, None] < 110)
    assert (coloured[forehead][:, 1] - coloured[forehead][:, 0]).mean() > 5 * (
        coloured[skin & ~forehead][:, 1] - coloured[skin & ~forehead][:, 0]
    ).mean()


def test_drawn_lashes_cast_a_faint_shadow_on_less_than_5_percent_of_the_head(reached):
    plain, seen = reached(Shadow())
    coloured, _ = reached(Shadow(coloured=True))
    darker = (plain - coloured).max(axis=2) > 0.02
    assert 0 < darker.sum() < 0.05 * (seen > 0).sum()
    assert (coloured - plain).max() <= 1 / 255


def test_bilinear_samples_halve_the_penumbra_error_of_nearest_samples(reached):
    """Compare both errors with a shadow of many samples (12.1)."""
    many, nearest, bilinear = (
        reached(Shadow(taps=taps, bilinear=mixed))[0] for taps, mixed in ((24, True), (6, False), (6, True))
    )
    errors = [np.sqrt(np.mean((light - many) ** 2)) for light in (nearest, bilinear)]
    assert 0.0 < errors[1] < 0.6 * errors[0]
