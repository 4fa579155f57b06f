"""Separable occlusion against exact occlusion, on a face and on a step that hides more."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.face.assets.mesh import PARTS
from kinesic.face.display import DisplayError, offscreen
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT
from kinesic.face.render.geometry import PositionBuffer, PositionPass
from kinesic.face.render.occlusion import OcclusionPass, directions, gaussian, radical_inverse, samples, wendland
from kinesic.face.render.passes import texture
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import TILES, Axes, Estimator, Falloff, Occlusion, Pattern

SIZE = 128
SCALE = 2000.0  # [pixels/m] of the scenes
FINE = Occlusion(size=21)


def opened(context: GlContext, scene: tuple[Floats, Floats], occlusion: Occlusion) -> Floats:
    """(height, width) openness of a scene of positions with parts, and normals; first row at the bottom."""
    position, normal = (texture(context, each, "f4") for each in scene)
    for each in (position, normal):
        each.filter = (gl.NEAREST, gl.NEAREST)
    return OcclusionPass(context, PositionBuffer(position, normal), occlusion).draw(SCALE).read()[::-1, :, 0]


def plane() -> tuple[Floats, Floats]:
    """A flat wall that faces the camera."""
    y, x = np.mgrid[:SIZE, :SIZE] / SCALE
    position = np.stack([x, y, np.full_like(x, -0.8), np.ones_like(x)], axis=-1)
    return position, np.broadcast_to((0.0, 0.0, 1.0, 0.0), position.shape).copy()


def step() -> tuple[Floats, Floats]:
    """A wall of which the right half stands 6 mm in front."""
    position, normal = plane()
    position[:, SIZE // 2 :, 2] += 0.006
    return position, normal


def heap() -> tuple[Floats, Floats]:
    """Boxes on a wall: more is hidden than on any face."""
    position, normal = plane()
    random = np.random.default_rng(5)
    for _ in range(30):
        left, low = random.integers(0, SIZE - 10, 2)
        wide, tall = random.integers(6, 40, 2)
        position[low : low + tall, left : left + wide, 2] = random.uniform(0.002, 0.02) - 0.8
    return position, normal


def of_face(portrait: Portrait, occlusion: Occlusion) -> tuple[Floats, Floats]:
    """(height, width) openness of a face and where its skin, eyes and mouth are."""
    geometry = portrait.pipeline.geometry
    with geometry.context as context:
        geometry.draw({"26": 0.6, "12": 0.5}, FRONT)
        marched = OcclusionPass(context, PositionPass(context, geometry).draw(), occlusion)
        scale = portrait.size[1] / (2 * FRONT.distance * np.tan(np.radians(FRONT.field_deg) / 2))
        found = marched.draw(scale).read()[..., 0]
        parts = geometry.parts()
        return found, (parts > 0) & (parts <= len(PARTS))


def test_separable_costs_four_times_less_at_21():
    assert samples(replace(FINE, exact=True)) / samples(FINE) > 4
    for size in (5, 11, 21):
        assert samples(Occlusion(size=size)) == 2 * (size - 1)


@pytest.mark.parametrize("estimator", get_args(Estimator))
@pytest.mark.parametrize("exact", [False, True])
def test_a_plane_is_open_and_the_foot_of_a_step_is_not(drawable: None, estimator: Estimator, exact: bool):
    told = replace(FINE, estimator=estimator, exact=exact)
    with offscreen() as context:
        flat, foot = opened(context, plane(), told), opened(context, step(), told)
    assert flat.min() > 0.999
    beside = foot[SIZE // 2, : SIZE // 2]
    assert beside[-3:].max() < 0.95
    assert np.all(beside[: SIZE // 2 - 50] > 0.999)  # out of reach
    assert foot[:, SIZE // 2 :].min() > 0.999  # what stands in front is not in its own shade


@pytest.mark.parametrize("estimator", ["angular", "crytek", "obscurance"])
def test_separable_is_near_to_exact_on_a_face(portrait: Portrait, estimator: Estimator):
    told = replace(FINE, estimator=estimator)
    (separable, face), (exact, _) = of_face(portrait, told), of_face(portrait, replace(told, exact=True))
    error = np.sqrt(np.mean((separable - exact)[face] ** 2))
    assert error <= (0.025 if estimator == "angular" else 0.05)
    assert np.corrcoef(separable[face], exact[face])[0, 1] > 0.95


@pytest.mark.parametrize("estimator", get_args(Estimator))
def test_separable_is_near_to_exact_where_much_is_hidden(drawable: None, estimator: Estimator):
    told = replace(FINE, estimator=estimator)
    with offscreen() as context:
        separable, exact = (opened(context, heap(), replace(told, exact=kind)) for kind in (False, True))
    assert exact.mean() < 0.97
    assert exact.std() > 0.03
    assert np.sqrt(np.mean((separable - exact) ** 2)) < 0.3 * exact.std()
    assert np.corrcoef(separable.ravel(), exact.ravel())[0, 1] > 0.95


@pytest.mark.parametrize("pattern", get_args(Pattern))
def test_every_pattern_serves_where_much_is_hidden(drawable: None, pattern: Pattern):
    with offscreen() as context:
        exact, separable = (
            opened(context, heap(), replace(FINE, pattern=pattern, exact=kind)) for kind in (True, False)
        )
    assert np.sqrt(np.mean((separable - exact) ** 2)) < 0.05


def test_directions_that_turn_come_nearer_to_exact_than_fixed_ones(drawable: None, monkeypatch: pytest.MonkeyPatch):
    """On a corner that only a diagonal direction sees."""
    position, normal = plane()
    position[SIZE // 2 :, SIZE // 2 :, 2] += 0.006
    with offscreen() as context:
        exact = opened(context, (position, normal), replace(FINE, exact=True))
        turning = opened(context, (position, normal), FINE)
        monkeypatch.setattr(
            "kinesic.face.render.occlusion.directions", lambda told, _: np.zeros((told.tile, told.tile))
        )
        fixed = opened(context, (position, normal), FINE)
    corner = np.s_[SIZE // 2 - 24 : SIZE // 2 - 4, SIZE // 2 - 24 : SIZE // 2 - 4]
    assert np.abs(turning - exact)[corner].mean() < 0.7 * np.abs(fixed - exact)[corner].mean()


def test_one_axis_sees_too_little_even_with_as_many_samples(drawable: None):
    """Figure 3.9: left half the cost, in the middle the same, on the right two axes."""
    one, same = replace(FINE, axes=1), replace(FINE, axes=1, size=2 * FINE.size)
    assert samples(FINE) / 2 == samples(one)
    assert samples(same) - samples(FINE) in (0, 2)
    with offscreen() as context:
        exact = opened(context, heap(), replace(FINE, exact=True))
        errors = [np.sqrt(np.mean((opened(context, heap(), each) - exact) ** 2)) for each in (one, same, FINE)]
    assert errors[0] > 1.2 * errors[2]
    assert errors[1] > 1.2 * errors[2]


@pytest.mark.parametrize("tile", TILES)
def test_a_blur_as_wide_as_the_pattern_takes_it_out(drawable: None, tile: int):
    """At the foot of a long step every row sees the same, whatever the pattern's size."""
    with offscreen() as context:
        foot = opened(context, step(), replace(FINE, tile=tile, pattern="regular"))[
            32:96, SIZE // 2 - 24 : SIZE // 2 - 4
        ]
    assert 0.1 < 1.0 - foot.min() < 1.0
    assert foot.std(axis=0).max() < 0.02


def test_noise_over_the_whole_picture_is_not_taken_out(drawable: None):
    """Figure 3.7: the same blur leaves chance behind, and no pattern."""
    with offscreen() as context:
        left = [
            opened(context, step(), replace(FINE, pattern=pattern))[32:96, SIZE // 2 - 24 : SIZE // 2 - 4].std(axis=0)
            for pattern in ("hammersley", "noise")
        ]
    assert left[1].mean() > 2.0 * left[0].mean()


@pytest.mark.parametrize("estimator", ["angular", "crytek"])
def test_a_gaussian_is_a_little_nearer_than_wendland(drawable: None, estimator: Estimator):
    """They are as wide at half their height, so that they differ, but not by much."""
    with offscreen() as context:
        wendlands, gaussians = (
            opened(context, heap(), replace(FINE, estimator=estimator, falloff=each)) for each in get_args(Falloff)
        )
    apart = np.abs(wendlands - gaussians)
    assert 0.001 < apart.mean() < 0.02
    assert np.corrcoef(wendlands.ravel(), gaussians.ravel())[0, 1] > 0.99


@pytest.mark.parametrize("pattern", get_args(Pattern))
@pytest.mark.parametrize(("axes", "range_"), [(1, np.pi), (2, np.pi / 2)])
def test_patterns_turn_within_what_the_axes_leave(pattern: Pattern, axes: Axes, range_: float):
    told = Occlusion(pattern=pattern, axes=axes, tile=5)
    found = directions(told, (8, 6))
    assert found.shape == ((6, 8) if pattern == "noise" else (5, 5))
    assert np.all((found >= 0.0) & (found < range_))
    assert len(np.unique(found)) == found.size
    np.testing.assert_array_equal(found, directions(told, (8, 6)))
    if pattern not in ("random", "noise"):
        assert np.diff(np.sort(found.ravel())).max() < range_ / 5


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ({"tile": 1}, "a pattern of 1 x 1 pixels; there are 2 to 8"),
        ({"tile": 9}, "a pattern of 9 x 9 pixels; there are 2 to 8"),
        ({"size": 1}, "occlusion with 1 samples across; there may be 2 to 63"),
    ],
)
def test_what_cannot_be_marched_is_told(told: dict[str, int], says: str):
    with pytest.raises(DisplayError, match=says):
        Occlusion(**told)


def test_radical_inverse_mirrors_digits():
    assert [radical_inverse(k, 2) for k in (1, 2, 3, 4)] == [0.5, 0.25, 0.75, 0.125]
    np.testing.assert_allclose(radical_inverse(5, 3), 2 / 3 + 1 / 9)


def test_wendland_falls_from_one_to_zero():
    assert wendland(np.array([0.0, 1.0, 1.5])).tolist() == [1.0, 0.0, 0.0]
    assert np.all(np.diff(wendland(np.linspace(0, 1, 50))) < 0)


def test_a_gaussian_is_half_as_high_where_wendland_is():
    half = np.array([0.3137])
    np.testing.assert_allclose(wendland(half), 0.5, atol=2e-3)
    np.testing.assert_allclose(gaussian(half), 0.5, atol=2e-2)
    assert gaussian(np.array([0.0, 1.0, 1.5])).tolist() == [1.0, 0.0, 0.0]
