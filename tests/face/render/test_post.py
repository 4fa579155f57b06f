"""Tests of scattering, depth of field and edge smoothing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from kinesic.body.arrays import Picture
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.gl import numbers as gl
from kinesic.face.render.camera import FRONT_CAMERA, Camera
from kinesic.face.render.occlusion import compute_wendland_weight
from kinesic.face.render.passes import ScreenPass, Target, make_texture
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET, Focus, Occlusion, Preset, Scattering

from ..conftest import Gallery

PICTURE_SIZE = (256, 256)
SIDE_CAMERA = Camera(yaw_deg=60.0)
PLAIN_PRESET = replace(NORMAL_PRESET, scattering=None, occlusion=Occlusion(size=5), smooth=False)


@pytest.fixture
def drawn(gallery: Gallery) -> Callable[..., NDArray[np.int64]]:
    """Function that draws the face at rest."""

    def draw(preset: Preset, camera: Camera = SIDE_CAMERA, size: tuple[int, int] = PICTURE_SIZE) -> NDArray[np.int64]:
        with gallery(preset, size) as portrait:
            return portrait.draw({}, camera).astype(np.int64)

    return draw


def sharpness(pixels: NDArray[np.int64]) -> float:
    """Return the mean difference of neighbouring pixels."""
    return float(np.abs(np.diff(pixels, axis=1)).mean())


def test_focused_eyes_stay_sharp_and_the_ear_behind_is_blurred(drawn):
    plain, blurred = (drawn(replace(NORMAL_PRESET, focus=focus), FRONT_CAMERA) for focus in (None, Focus(circle=0.3)))
    eyes, ear = np.s_[90:112, 85:170], np.s_[95:145, 55:74]
    assert np.abs(blurred - plain)[eyes].mean() < 1.0
    assert sharpness(blurred[ear]) < 0.9 * sharpness(plain[ear])
    assert abs(blurred.mean() - plain.mean()) < 2.0


def test_depth_of_field_does_not_blur_the_head_into_the_background(drawn):
    plain, blurred = (drawn(replace(DRAFT_PRESET, focus=focus), FRONT_CAMERA) for focus in (None, Focus(circle=0.12)))
    apart = np.abs(blurred - plain).max(axis=2)
    assert apart[30:200, :30].max() <= 2  # next to the head, within the circle of the shoulders


def test_depth_of_field_with_a_larger_circle_of_confusion_blurs_more(drawn):
    plain = drawn(DRAFT_PRESET)
    apart = [
        float(np.abs(drawn(replace(DRAFT_PRESET, focus=Focus(circle=c))) - plain).mean()) for c in (0.0, 0.03, 0.12)
    ]
    assert apart[0] < 0.01
    assert apart[0] < apart[1] < apart[2]


def test_focus_distance_selects_the_sharp_region_of_the_picture(drawn):
    """Compare focus planes through the nearer eye and through the ear."""
    usual, eyes, ear = (
        drawn(replace(NORMAL_PRESET, focus=Focus(circle=0.3, plane=plane)), FRONT_CAMERA)
        for plane in (None, 0.78, 0.87)
    )
    at_eyes, at_ear = np.s_[90:112, 85:170], np.s_[95:145, 55:74]
    assert np.abs(eyes - usual)[at_eyes].mean() < 1.0
    assert sharpness(ear[at_eyes]) < 0.9 * sharpness(usual[at_eyes])
    assert sharpness(ear[at_ear]) > 1.1 * sharpness(usual[at_ear])


def test_focus_range_that_contains_the_head_keeps_the_whole_head_sharp(drawn):
    plain, remaining = (
        drawn(replace(DRAFT_PRESET, focus=focus), FRONT_CAMERA) for focus in (None, Focus(plane=0.85, within=0.4))
    )
    assert np.abs(remaining - plain)[60:160, 95:160].max() <= 1


def test_anti_aliasing_changes_mainly_high_contrast_edges(drawn):
    plain, smoothed = drawn(DRAFT_PRESET), drawn(replace(DRAFT_PRESET, smooth=True))
    changed = np.abs(smoothed - plain).max(axis=2) > 0
    steep = np.maximum(np.abs(np.diff(plain, axis=0, prepend=0)), np.abs(np.diff(plain, axis=1, prepend=0))).max(axis=2)
    assert 0.001 < changed.mean() < 0.15
    assert steep[changed].mean() > 4 * steep[~changed].mean()


def test_supersampled_face_picture_is_the_average_of_a_larger_picture(drawn):
    mean = drawn(DRAFT_PRESET, size=(512, 512)).astype(np.float64).reshape(256, 2, 256, 2, 3).mean(axis=(1, 3))
    assert np.abs(drawn(replace(DRAFT_PRESET, samples=2)) - mean).max() <= 1.0


@pytest.fixture(scope="module")
def smiling(gallery: Gallery) -> Callable[[Preset], Picture]:
    """Function that draws a faint smile."""

    def draw(preset: Preset) -> Picture:
        with gallery(preset, (192, 192)) as portrait:
            return portrait.draw({"12": 0.5})

    return draw


def apart(one: Picture, other: Picture) -> float:
    return float(np.abs(one.astype(float) - other.astype(float)).mean())


@pytest.fixture(scope="module")
def unscattered(smiling) -> Picture:
    return smiling(PLAIN_PRESET)


def test_negative_threshold_of_skin_scattering_filters_nothing(smiling, unscattered: Picture):
    np.testing.assert_array_equal(smiling(replace(PLAIN_PRESET, scattering=Scattering(threshold=-1.0))), unscattered)


def test_higher_threshold_of_skin_scattering_filters_more(smiling, unscattered: Picture):
    effects = [
        apart(smiling(replace(PLAIN_PRESET, scattering=Scattering(threshold=item))), unscattered)
        for item in (0.7, 0.93, 1.0)
    ]
    assert 0.0 < effects[0] < effects[1] < effects[2]


def test_skin_scattering_preserves_the_mean_brightness(smiling, unscattered: Picture):
    full = smiling(replace(PLAIN_PRESET, scattering=Scattering(threshold=1.0)))
    assert abs(full.astype(float).mean() - unscattered.astype(float).mean()) < 0.5
    assert np.abs(full.astype(int) - unscattered.astype(int)).max() > 5


FULL_SCATTERING = Scattering(threshold=1.0, steps=5)


def test_three_scattering_levels_change_the_skin_less_than_full_scattering(smiling, unscattered: Picture):
    full, levels, one = (
        smiling(replace(PLAIN_PRESET, scattering=item))
        for item in (FULL_SCATTERING, replace(FULL_SCATTERING, levels=3), replace(FULL_SCATTERING, levels=1))
    )
    np.testing.assert_array_equal(full, one)
    assert 0.2 * apart(full, unscattered) < apart(levels, unscattered) < 0.99 * apart(full, unscattered)
    assert apart(levels, full) > 0.0


def test_pixels_with_more_occlusion_get_a_higher_level_of_skin_scattering(gallery: Gallery):
    """Compare scattering levels with openness on even skin (Figure 5.2)."""
    preset = replace(PLAIN_PRESET, scattering=replace(FULL_SCATTERING, levels=3), coarse=1)
    with gallery(preset, (192, 192)) as portrait:
        portrait.draw({})
        pipeline = portrait.pipeline
        blurred = pipeline.occlusion.blurs[-1].target.read(0)[..., 0]
        level = np.rint(3 * pipeline.scatter.levels() / 255.0)
    assert set(np.unique(level)) == {0.0, 1.0, 2.0, 3.0}
    means = [blurred[level == item].mean() for item in (1.0, 2.0)]
    assert means[0] > means[1] + 0.05


def test_skin_scattering_weights_a_neighbour_by_the_cosine_between_both_normals(drawable: None):
    """Check the linear normal term of the trilateral filter (5.1.5)."""
    bent, diffuse = np.zeros((2, 1, 6, 4))
    turned = np.arange(6) >= 3
    bent[0, :, :3] = np.where(turned[:, None], (np.sqrt(0.75), 0.0, 0.5), (0.0, 0.0, 1.0))
    diffuse[0, turned, :3] = 1.0
    with open_offscreen_context() as context:
        target = Target(context, (6, 1), ("4f4",), None)
        defines = {"STEPS": 2, "LEVELS": 1, "LAST": 0}
        scatter = ScreenPass(context, target, "scatter", where="everywhere", defines=defines)
        inputs = {name: make_texture(context, item, "f4") for name, item in (("bent", bent), ("diffuse", diffuse))}
        for item in inputs.values():
            item.filter = (gl.GL_NEAREST, gl.GL_NEAREST)
        red = scatter.draw(inputs, {"axis": (1 / 6, 0.0), "width": 0.01}).read()[0, 2, 0]
    near = compute_wendland_weight(0.5)
    assert red == pytest.approx(0.5 * near / (1.0 + near + 0.5 * near), rel=1e-4)


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ({"levels": 4}, "light spreads in 4 levels; with 3 samples there are 1 to 3"),
        ({"levels": 2, "threshold": 0.5}, "all levels at openness 0.6; it must be below the threshold 0.5"),
    ],
)
def test_invalid_scattering_levels_are_rejected(told: dict[str, float], says: str):
    with pytest.raises(DisplayError, match=says):
        Scattering(**told)
