"""Tests of sliding eyelids: contact, penetration and lashes."""

import numpy as np
import pytest

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.face.assets.action_units import compute_gaze_rotation, deform, read_intensities
from kinesic.face.assets.lids import SKIN_CLEARANCE, Lids, find_lids
from kinesic.face.assets.mesh import FACE_VARIANTS, Mesh, load_head
from kinesic.face.assets.paint import IRIS_RADIUS

SIDE_NAMES = ("Left", "Right")


@pytest.fixture(scope="module", params=FACE_VARIANTS)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head(request.param)


@pytest.fixture(scope="module")
def eyes(mesh: Mesh) -> list[Lids]:
    return [find_lids(mesh, side, number) for number, side in enumerate(SIDE_NAMES)]


def heights(eye: Lids, positions: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return lateral position and elevation [rad] along a lid edge."""
    points = positions[edge] - eye.centre
    return points[:, 1], np.arctan2(points[:, 2], points[:, 0])


def gap(eye: Lids, positions: np.ndarray) -> np.ndarray:
    """Return the angles between the lids along the middle of the eye."""
    aside = np.linspace(-0.5, 0.5, 9) * eye.radius
    top, bottom = (np.interp(aside, *heights(eye, positions, edge)) for edge in (eye.upper, eye.lower))
    return top - bottom


def test_eyelid_edges_run_from_corner_to_corner_of_the_eye(mesh: Mesh, eyes: list[Lids]):
    for eye in eyes:
        assert eye.upper[0] == eye.lower[0]
        assert eye.upper[-1] == eye.lower[-1]
        assert np.ptp(mesh.positions[eye.upper, 1]) > 1.5 * eye.radius
        assert np.all(gap(eye, mesh.positions) > np.radians(15))


def test_lids_at_rest_are_open_over_two_thirds_of_the_iris_height(mesh: Mesh, eyes: list[Lids]):
    """Prevent lowered lids, which make the iris look square."""
    for eye in eyes:
        assert gap(eye, mesh.positions)[4] > 0.66 * 2.0 * IRIS_RADIUS


@pytest.mark.parametrize("also", [{}, {"5": 1.0}, {"7": 0.8, "6": 1.0}, {"64": 1.0}, {"63": 1.0, "1": 1.0}])
def test_closed_lids_meet_also_while_other_lid_or_brow_or_gaze_units_are_active(
    mesh: Mesh, eyes: list[Lids], also: dict[str, float]
):
    for eye in eyes:
        assert np.degrees(np.abs(gap(eye, deform(mesh, {"43": 1.0, **also})))).max() < 1.5


def test_eye_opening_decreases_with_each_step_of_lid_closure_intensity(mesh: Mesh, eyes: list[Lids]):
    vectors = [gap(eyes[0], deform(mesh, {"43": fraction})).mean() for fraction in np.linspace(0.0, 1.0, 11)]
    gone = 1.0 - np.array(vectors) / vectors[0]
    assert np.all(np.diff(gone) > 0.0)
    assert 0.3 < gone[4] < 0.5


def test_eyelids_of_random_expressions_do_not_penetrate_the_eyeball(mesh: Mesh, eyes: list[Lids]):
    random = np.random.default_rng(5)
    for _ in range(25):
        shown = {name: float(random.uniform()) for name in random.choice(FACE_CHANNELS, 6, replace=False)}
        positions, given_values = deform(mesh, shown), read_intensities(shown)
        for number, eye in enumerate(eyes):
            spokes = positions[eye.skin] - eye.centre
            away = np.linalg.norm(spokes, axis=1)
            surface = eye.surface(spokes / away[:, None], compute_gaze_rotation(given_values, number)[:, 0])
            outside = eye.clearance > 0.9 * SKIN_CLEARANCE
            assert outside.sum() > 100
            assert np.all(away[outside] > surface[outside] + 0.8 * SKIN_CLEARANCE), shown


def test_eyelash_roots_stay_within_4_mm_of_the_lid_edges(mesh: Mesh, eyes: list[Lids]):
    roots = mesh.tips < 0.2
    for units in ({}, {"43": 1.0}, {"43": 0.5, "61": 1.0}, {"5": 1.0, "6": 0.7}):
        positions = deform(mesh, units)
        for eye in eyes:
            edge = positions[np.concatenate([eye.upper, eye.lower])]
            selected = positions[eye.lashes[roots[eye.lashes]]]
            assert len(selected) > 10
            assert np.linalg.norm(selected[:, None] - edge, axis=2).min(axis=1).max() < 4e-3


def test_half_crossed_eyes_converge_at_0_15_to_0_4_m_in_front_of_the_face(mesh: Mesh):
    left, right = (compute_gaze_rotation(read_intensities({"66": 0.5}), number)[:, 0] for number in (0, 1))
    assert left[1] < 0.0 < right[1]
    np.testing.assert_allclose(left * (1.0, -1.0, 1.0), right)
    assert 0.15 < mesh.eyes[0, 1] * left[0] / -left[1] < 0.4  # [m]
