"""Tests of separable against exact occlusion on a face and on scenes."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT_CAMERA
from kinesic.face.render.geometry import PositionBuffer, PositionPass
from kinesic.face.render.occlusion import (
    OcclusionPass,
    compute_gaussian_weight,
    compute_radical_inverse,
    compute_wendland_weight,
    count_samples,
    make_direction_tile,
)
from kinesic.face.render.passes import make_texture
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import TILE_SIZES, Axes, Estimator, Falloff, Occlusion, Pattern

PICTURE_SIDE = 128
PIXEL_SCALE = 2000.0  # [pixels/m] scale of the pictures of the scenes
FINE_OCCLUSION = Occlusion(size=21)


def opened(context: GlContext, scene: tuple[Floats, Floats], occlusion: Occlusion) -> Floats:
    """Return the (height, width) openness of a scene, bottom row first.

    The scene consists of positions with parts, and normals.
    """
    position, normal = (make_texture(context, item, "f4") for item in scene)
    for item in (position, normal):
        item.filter = (gl.GL_NEAREST, gl.GL_NEAREST)
    return OcclusionPass(context, PositionBuffer(position, normal), occlusion).draw(PIXEL_SCALE).read()[::-1, :, 0]


def plane() -> tuple[Floats, Floats]:
    """Return a flat wall that faces the camera."""
    y, x = np.mgrid[:PICTURE_SIDE, :PICTURE_SIDE] / PIXEL_SCALE
    position = np.stack([x, y, np.full_like(x, -0.8), np.ones_like(x)], axis=-1)
    return position, np.broadcast_to((0.0, 0.0, 1.0, 0.0), position.shape).copy()


def step() -> tuple[Floats, Floats]:
    """Return a wall whose right half is 6 mm in front."""
    position, normal = plane()
    position[:, PICTURE_SIDE // 2 :, 2] += 0.006
    return position, normal


def heap() -> tuple[Floats, Floats]:
    """Return boxes on a wall, which occlude more than any face."""
    position, normal = plane()
    random = np.random.default_rng(5)
    for _ in range(30):
        left, low = random.integers(0, PICTURE_SIDE - 10, 2)
        wide, tall = random.integers(6, 40, 2)
        position[low : low + tall, left : left + wide, 2] = random.uniform(0.002, 0.02) - 0.8
    return position, normal


def of_face(portrait: Portrait, occlusion: Occlusion) -> tuple[Floats, Floats]:
    """Return the (height, width) openness of a face and its mask."""
    geometry = portrait.pipeline.geometry
    with geometry.context as context:
        geometry.draw({"26": 0.6, "12": 0.5}, FRONT_CAMERA)
        marched = OcclusionPass(context, PositionPass(context, geometry).draw(), occlusion)
        scale = portrait.size[1] / (2 * FRONT_CAMERA.distance * np.tan(np.radians(FRONT_CAMERA.field_deg) / 2))
        actual = marched.draw(scale).read()[..., 0]
        parts = geometry.parts()
        return actual, (parts > 0) & (parts <= len(MESH_PARTS))


def test_separable_occlusion_needs_less_than_a_quarter_of_the_samples_of_exact_occlusion():
    assert count_samples(replace(FINE_OCCLUSION, exact=True)) / count_samples(FINE_OCCLUSION) > 4
    for size in (5, 11, 21):
        assert count_samples(Occlusion(size=size)) == 2 * (size - 1)


@pytest.mark.parametrize("estimator", get_args(Estimator))
@pytest.mark.parametrize("exact", [False, True])
def test_occlusion_of_a_plane_is_zero_and_of_a_step_foot_large(drawable: None, estimator: Estimator, exact: bool):
    settings = replace(FINE_OCCLUSION, estimator=estimator, exact=exact)
    with open_offscreen_context() as context:
        flat, foot = opened(context, plane(), settings), opened(context, step(), settings)
    assert flat.min() > 0.999
    neighbours = foot[PICTURE_SIDE // 2, : PICTURE_SIDE // 2]
    assert neighbours[-3:].max() < 0.95
    assert np.all(neighbours[: PICTURE_SIDE // 2 - 50] > 0.999)  # out of reach
    assert foot[:, PICTURE_SIDE // 2 :].min() > 0.999  # the front part has no self shadow


def test_occlusion_by_depth_alone_darkens_slopes_that_the_tangent_plane_keeps_bright(drawable: None):
    """Use a slope, half of which is nearer than its middle."""
    position, _ = plane()
    position[..., 2] += position[..., 0]
    tilted = np.broadcast_to(np.array([-1.0, 0.0, 1.0, 0.0]) / np.sqrt(2.0), position.shape).copy()
    middle = np.s_[56:72, 56:72]
    with open_offscreen_context() as context:
        plain, above = (
            opened(context, (position, tilted), replace(FINE_OCCLUSION, estimator=estimator))[middle]
            for estimator in ("depth", "crytek")
        )
    assert above.min() > 0.999
    np.testing.assert_allclose(plain, 1.0 - 0.25 * FINE_OCCLUSION.strength, atol=0.03)


@pytest.mark.parametrize("estimator", ["angular", "crytek", "obscurance", "depth"])
def test_separable_ambient_occlusion_approximates_exact_occlusion_on_a_face(portrait: Portrait, estimator: Estimator):
    settings = replace(FINE_OCCLUSION, estimator=estimator)
    (separable, face), (exact, _) = of_face(portrait, settings), of_face(portrait, replace(settings, exact=True))
    error = np.sqrt(np.mean((separable - exact)[face] ** 2))
    assert error <= (0.025 if estimator == "angular" else 0.05)
    assert np.corrcoef(separable[face], exact[face])[0, 1] > 0.95


@pytest.mark.parametrize("estimator", get_args(Estimator))
def test_separable_ambient_occlusion_approximates_exact_occlusion_in_deep_scenes(drawable: None, estimator: Estimator):
    settings = replace(FINE_OCCLUSION, estimator=estimator)
    with open_offscreen_context() as context:
        separable, exact = (opened(context, heap(), replace(settings, exact=kind)) for kind in (False, True))
    assert exact.mean() < 0.97
    assert exact.std() > 0.03
    assert np.sqrt(np.mean((separable - exact) ** 2)) < 0.3 * exact.std()
    assert np.corrcoef(separable.ravel(), exact.ravel())[0, 1] > 0.95


@pytest.mark.parametrize("pattern", get_args(Pattern))
def test_ambient_occlusion_is_close_to_the_exact_one_with_every_sample_pattern(drawable: None, pattern: Pattern):
    with open_offscreen_context() as context:
        exact, separable = (
            opened(context, heap(), replace(FINE_OCCLUSION, pattern=pattern, exact=kind)) for kind in (True, False)
        )
    assert np.sqrt(np.mean((separable - exact) ** 2)) < 0.05


def test_ambient_occlusion_with_rotated_sample_directions_is_more_accurate_than_with_fixed_ones(
    drawable: None, monkeypatch: pytest.MonkeyPatch
):
    """Use a corner that only diagonal sample directions reach."""
    position, normal = plane()
    position[PICTURE_SIDE // 2 :, PICTURE_SIDE // 2 :, 2] += 0.006
    with open_offscreen_context() as context:
        exact = opened(context, (position, normal), replace(FINE_OCCLUSION, exact=True))
        turning = opened(context, (position, normal), FINE_OCCLUSION)
        monkeypatch.setattr(
            "kinesic.face.render.occlusion.make_direction_tile", lambda told, _: np.zeros((told.tile, told.tile))
        )
        fixed = opened(context, (position, normal), FINE_OCCLUSION)
    corner = np.s_[PICTURE_SIDE // 2 - 24 : PICTURE_SIDE // 2 - 4, PICTURE_SIDE // 2 - 24 : PICTURE_SIDE // 2 - 4]
    assert np.abs(turning - exact)[corner].mean() < 0.7 * np.abs(fixed - exact)[corner].mean()


def test_occlusion_along_one_axis_is_less_accurate_than_along_two_axes(drawable: None):
    """Compare one axis at half and at full cost (Figure 3.9)."""
    one, same = replace(FINE_OCCLUSION, axes=1), replace(FINE_OCCLUSION, axes=1, size=2 * FINE_OCCLUSION.size)
    assert count_samples(FINE_OCCLUSION) / 2 == count_samples(one)
    assert count_samples(same) - count_samples(FINE_OCCLUSION) in (0, 2)
    with open_offscreen_context() as context:
        exact = opened(context, heap(), replace(FINE_OCCLUSION, exact=True))
        errors = [
            np.sqrt(np.mean((opened(context, heap(), item) - exact) ** 2)) for item in (one, same, FINE_OCCLUSION)
        ]
    assert errors[0] > 1.2 * errors[2]
    assert errors[1] > 1.2 * errors[2]


@pytest.mark.parametrize("tile", TILE_SIZES)
def test_occlusion_blur_removes_a_sample_pattern_of_its_width(drawable: None, tile: int):
    """Expect equal rows at the foot of a step."""
    with open_offscreen_context() as context:
        foot = opened(context, step(), replace(FINE_OCCLUSION, tile=tile, pattern="regular"))[
            32:96, PICTURE_SIDE // 2 - 24 : PICTURE_SIDE // 2 - 4
        ]
    assert 0.1 < 1.0 - foot.min() < 1.0
    assert foot.std(axis=0).max() < 0.02


def test_occlusion_blur_does_not_remove_full_screen_noise(drawable: None):
    """Compare the residual deviations of noise and a Hammersley pattern (Figure 3.7)."""
    with open_offscreen_context() as context:
        left = [
            opened(context, step(), replace(FINE_OCCLUSION, pattern=pattern))[
                32:96, PICTURE_SIDE // 2 - 24 : PICTURE_SIDE // 2 - 4
            ].std(axis=0)
            for pattern in ("hammersley", "noise")
        ]
    assert left[1].mean() > 2.0 * left[0].mean()


@pytest.mark.parametrize("estimator", ["angular", "crytek"])
def test_gaussian_and_wendland_falloff_differ_slightly(drawable: None, estimator: Estimator):
    """Compare two falloff functions of equal half width."""
    with open_offscreen_context() as context:
        wendlands, gaussians = (
            opened(context, heap(), replace(FINE_OCCLUSION, estimator=estimator, falloff=item))
            for item in get_args(Falloff)
        )
    apart = np.abs(wendlands - gaussians)
    assert 0.001 < apart.mean() < 0.02
    assert np.corrcoef(wendlands.ravel(), gaussians.ravel())[0, 1] > 0.99


@pytest.mark.parametrize("pattern", get_args(Pattern))
@pytest.mark.parametrize(("axes", "range_"), [(1, np.pi), (2, np.pi / 2)])
def test_occlusion_sampling_angles_stay_in_the_range_of_the_axis_count(pattern: Pattern, axes: Axes, range_: float):
    settings = Occlusion(pattern=pattern, axes=axes, tile=5)
    actual = make_direction_tile(settings, (8, 6))
    assert actual.shape == ((6, 8) if pattern == "noise" else (5, 5))
    assert np.all((actual >= 0.0) & (actual < range_))
    assert len(np.unique(actual)) == actual.size
    np.testing.assert_array_equal(actual, make_direction_tile(settings, (8, 6)))
    if pattern not in ("random", "noise"):
        assert np.diff(np.sort(actual.ravel())).max() < range_ / 5


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ({"tile": 1}, "a pattern of 1 x 1 pixels; use 2 to 8"),
        ({"tile": 9}, "a pattern of 9 x 9 pixels; use 2 to 8"),
        ({"size": 1}, "occlusion with 1 samples across; use 2 to 63"),
    ],
)
def test_invalid_occlusion_parameters_are_rejected(told: dict[str, int], says: str):
    with pytest.raises(DisplayError, match=says):
        Occlusion(**told)


def test_radical_inverse_mirrors_the_digits_of_a_sample_number_at_the_radix_point():
    assert [compute_radical_inverse(k, 2) for k in (1, 2, 3, 4)] == [0.5, 0.25, 0.75, 0.125]
    np.testing.assert_allclose(compute_radical_inverse(5, 3), 2 / 3 + 1 / 9)


def test_wendland_occlusion_falloff_decreases_from_one_to_zero():
    assert compute_wendland_weight(np.array([0.0, 1.0, 1.5])).tolist() == [1.0, 0.0, 0.0]
    assert np.all(np.diff(compute_wendland_weight(np.linspace(0, 1, 50))) < 0)


def test_gaussian_and_wendland_occlusion_falloffs_have_equal_half_width():
    half = np.array([0.3137])
    np.testing.assert_allclose(compute_wendland_weight(half), 0.5, atol=2e-3)
    np.testing.assert_allclose(compute_gaussian_weight(half), 0.5, atol=2e-2)
    assert compute_gaussian_weight(np.array([0.0, 1.0, 1.5])).tolist() == [1.0, 0.0, 0.0]
