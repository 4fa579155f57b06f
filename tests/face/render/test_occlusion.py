"""Separable occlusion against exact occlusion, on a face and on a step that hides more."""

from dataclasses import replace
from typing import get_args

import moderngl
import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.face.assets.mesh import PARTS
from kinesic.face.display import offscreen
from kinesic.face.render.camera import FRONT
from kinesic.face.render.geometry import PositionBuffer, PositionPass
from kinesic.face.render.occlusion import SIDE, OcclusionPass, directions, radical_inverse, samples, wendland
from kinesic.face.render.passes import texture
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import Estimator, Occlusion, Pattern

SIZE = 128
SCALE = 2000.0  # [pixels/m] of the scenes
FINE = Occlusion(size=21)


def opened(context: moderngl.Context, scene: tuple[Floats, Floats], occlusion: Occlusion) -> Floats:
    """(height, width) openness of a scene of positions with parts, and normals; first row at the bottom."""
    position, normal = (texture(context, each, "f4") for each in scene)
    for each in (position, normal):
        each.filter = (moderngl.NEAREST, moderngl.NEAREST)
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
        monkeypatch.setattr("kinesic.face.render.occlusion.directions", lambda _: np.zeros((SIDE, SIDE)))
        fixed = opened(context, (position, normal), FINE)
    corner = np.s_[SIZE // 2 - 24 : SIZE // 2 - 4, SIZE // 2 - 24 : SIZE // 2 - 4]
    assert np.abs(turning - exact)[corner].mean() < 0.7 * np.abs(fixed - exact)[corner].mean()


@pytest.mark.parametrize("pattern", get_args(Pattern))
def test_patterns_turn_within_a_quarter(pattern: Pattern):
    found = directions(pattern)
    assert found.shape == (SIDE, SIDE)
    assert np.all((found >= 0.0) & (found < np.pi / 2))
    assert len(np.unique(found)) == SIDE * SIDE
    np.testing.assert_array_equal(found, directions(pattern))
    if pattern != "random":
        assert np.diff(np.sort(found.ravel())).max() < np.pi / 2 / SIDE


def test_radical_inverse_mirrors_digits():
    assert [radical_inverse(k, 2) for k in (1, 2, 3, 4)] == [0.5, 0.25, 0.75, 0.125]
    np.testing.assert_allclose(radical_inverse(5, 3), 2 / 3 + 1 / 9)


def test_wendland_falls_from_one_to_zero():
    assert wendland(np.array([0.0, 1.0, 1.5])).tolist() == [1.0, 0.0, 0.0]
    assert np.all(np.diff(wendland(np.linspace(0, 1, 50))) < 0)
