"""Tests of hair on the skull: coverage, clearance and shape of locks."""

from functools import cache

import numpy as np
import pytest
import scipy

from kinesic.body.choices import Variant
from kinesic.face.assets.chart import measure_hairline_height
from kinesic.face.assets.hair import CUT_VARIATION, Locks, grow_locks
from kinesic.face.assets.hair_roots import EAR_REGION, HEAD_CENTRE, SIDEBURN_HEIGHT
from kinesic.face.assets.hair_styles import HAIR_STYLES
from kinesic.face.assets.mesh import FACE_VARIANTS, load_head


@cache
def locks(variant: Variant) -> tuple[Locks, np.ndarray]:
    """Return the locks of hair and their vertex positions [eye distances]."""
    mesh = load_head(variant)
    actual = grow_locks(mesh, HAIR_STYLES[variant])
    return actual, actual.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])


def edges(variant: Variant) -> np.ndarray:
    """Return the (locks, along, 2 edges, 3) vertices of locks."""
    return locks(variant)[1].reshape(-1, HAIR_STYLES[variant].steps + 1, 2, 3)


def lengths(variant: Variant) -> np.ndarray:
    """Return the (locks, steps) lengths along the middle of locks."""
    return np.linalg.norm(np.diff(edges(variant).mean(axis=2), axis=1), axis=2)


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_hair_covers_the_skull_but_not_the_face(variant: Variant):
    actual, (forward, left, up) = locks(variant)[0], locks(variant)[1].T
    assert np.isfinite(actual.positions).all()
    np.testing.assert_allclose(np.linalg.norm(actual.normals, axis=1), 1.0)
    assert not ((forward > 0.0) & (np.abs(left) < 0.9) & (up > -2.0) & (up < 0.8)).any()
    for place in ((-0.6, 0.8, 0.9), (-1.2, -0.9, 0.8), (-2.9, 0.0, 0.4), (-1.1, 0.2, 1.7)):
        assert np.linalg.norm(locks(variant)[1] - place, axis=1).min() < 0.5, place


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_hair_stays_outside_the_head(variant: Variant):
    mesh = load_head(variant)
    skin = mesh.positions[mesh.vertices("skin")] / (mesh.eyes[0, 1] - mesh.eyes[1, 1]) - HEAD_CENTRE
    far = np.linalg.norm(skin, axis=1)
    positions = locks(variant)[1][::5]
    spokes = positions - HEAD_CENTRE
    away = np.linalg.norm(spokes, axis=1)
    nearest = (spokes / away[:, None] @ (skin / far[:, None]).T).argmax(axis=1)
    high = positions[:, 2] > 0.0
    assert np.mean(away[high] > far[nearest][high] - 0.03) > 0.97


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_hair_locks_face_outward_and_hanging_locks_are_double_sided(variant: Variant):
    actual, _ = locks(variant)
    for triangles, outward in ((actual.triangles, 1.0), (actual.inside, -1.0)):
        a, b, c = actual.positions[triangles].transpose(1, 0, 2)
        facing = outward * np.einsum("ti,ti->t", np.cross(b - a, c - a), actual.normals[triangles[:, 0]]) > 0.0
        assert facing.mean() > 0.95
    assert len(actual.inside) < 0.8 * len(actual.triangles)
    item = actual.inside[:, 0] // (2 * (HAIR_STYLES[variant].steps + 1))
    assert set(np.unique(item, return_counts=True)[1]) == {
        2 * HAIR_STYLES[variant].steps
    }  # otherwise a lock would start with a step
    assert actual.places[:, 0].min() == -1.0
    assert actual.places[:, 0].max() == 1.0


def test_hair_styles_differ_in_length():
    woman, man = (locks(variant)[1] for variant in FACE_VARIANTS)
    assert woman[:, 2].min() < -1.3
    assert man[:, 2].min() > -0.9


def test_hair_generation_is_deterministic():
    mesh = load_head("male")
    np.testing.assert_array_equal(grow_locks(mesh, HAIR_STYLES["male"]).positions, locks("male")[0].positions)


def test_short_sideburns_have_no_locks():
    """Prevent thick patches of hair in front of the ears."""
    forward, _, up = edges("male")[:, 0].mean(axis=1).T
    assert up[forward > EAR_REGION[0]].min() > SIDEBURN_HEIGHT
    assert measure_hairline_height(np.array([[-0.75, 1.1, -0.1]]))[0] > 0.1
    assert measure_hairline_height(np.array([[-0.3, 1.0, 0.2]]))[0] < -0.1


@pytest.mark.parametrize(("variant", "tip"), [("female", 0.07), ("male", 0.05)])
def test_hair_locks_start_narrow_and_end_blunt(variant: Variant, tip: float):
    """Prevent visible steps at wide roots and dots at thin tips."""
    points = edges(variant)
    widths = np.linalg.norm(points[:, :, 0] - points[:, :, 1], axis=2) / (2.0 * HAIR_STYLES[variant].width[0])
    first = measure_hairline_height(points[:, 0].mean(axis=1)) < 0.08
    assert first.sum() > 5
    assert np.percentile(widths[first, 0], 90) < 0.8
    assert widths[:, -1].min() > tip


def test_short_hair_lies_flat_on_the_neck():
    """Expect narrow locks whose tips are near the skin of the neck."""
    mesh = load_head("male")
    skin = mesh.positions[mesh.vertices("skin")] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    tips = edges("male")[:, -1].mean(axis=1)
    away, _ = scipy.spatial.cKDTree(skin).query(tips[tips[:, 2] < -0.3])
    assert np.percentile(away, 90) < 0.16
    low = edges("male")[:, 0, 0, 2] < 0.1
    widths = np.linalg.norm(edges("male")[low, :, 0] - edges("male")[low, :, 1], axis=2).max(axis=1)
    assert np.median(widths / lengths("male")[low].sum(axis=1)) < 0.35


def test_hair_covers_the_crown_of_the_head():
    """Cast rays from inside the head behind the forehead."""
    vectors = np.random.default_rng(3).standard_normal((1200, 3))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    crown = vectors[(vectors[:, 2] > 0.5) & (vectors[:, 0] < 0.1)]
    a, b, c = (locks("female")[1][locks("female")[0].triangles] - HEAD_CENTRE).transpose(1, 0, 2)
    within = [crown @ np.cross(one, other).T > 0.0 for one, other in ((b, c), (c, a), (a, b))]
    assert np.all(within, axis=0).any(axis=1).mean() > 0.93


def test_long_hair_rises_gently_over_ears():
    middles = edges("female").mean(axis=2)
    rises = np.diff(np.linalg.norm(middles - HEAD_CENTRE, axis=2), axis=1) / lengths("female")
    neighbours = (np.abs(middles[:, 1:, 1]) > 0.9) & (middles[:, 1:, 2] < 0.5) & (middles[:, 1:, 2] > -0.6)
    assert np.percentile(rises[neighbours], 90) < 0.35


def test_short_hair_leaves_the_ears_free():
    forward, left, up = np.moveaxis(edges("male").mean(axis=2), -1, 0)
    back, front, low, high, aside = EAR_REGION
    assert not ((forward > back) & (forward < front) & (up > low) & (up < high) & (np.abs(left) > aside)).any()


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_hair_locks_end_above_the_cut_height_of_the_hair_style(variant: Variant):
    assert edges(variant).mean(axis=2)[:, :, 2].min() > HAIR_STYLES[variant].cut + CUT_VARIATION[0] - 1e-9


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_hairline_has_closely_spaced_narrow_locks(variant: Variant):
    """Prevent gaps that show the painted scalp between roots."""
    roots = edges(variant)[:, 0].mean(axis=1)
    front = roots[(measure_hairline_height(roots) < 0.16) & (roots[:, 0] > -0.6)]
    turns = np.degrees(np.sort(np.arctan2(front[:, 1], front[:, 0] - HEAD_CENTRE[0])))
    assert np.diff(turns[np.abs(turns) < 50.0]).max() < 4.0


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_5_to_35_percent_of_hair_locks_are_much_narrower_than_the_median(variant: Variant):
    points = edges(variant)
    widest = np.linalg.norm(points[:, :, 0] - points[:, :, 1], axis=2).max(axis=1)
    assert 0.05 < np.mean(widest < 0.4 * np.median(widest)) < 0.35


def test_strand_directions_follow_the_locks():
    actual = locks("female")[0]
    rows = HAIR_STYLES["female"].steps + 1
    strands = actual.strands.reshape(-1, rows, 2, 3)[:, 1:-1].mean(axis=2)
    steps = np.diff(edges("female").mean(axis=2), axis=1)
    steps /= np.linalg.norm(steps, axis=2, keepdims=True)
    assert np.median(np.sum(strands * steps[:, :-1], axis=2)) > 0.97
    np.testing.assert_allclose(np.linalg.norm(actual.strands, axis=1), 1.0)


def test_front_edge_of_long_hair_touches_the_cheeks():
    """Prevent a gap between cheek and hair in the front view."""
    mesh = load_head("female")
    skin = mesh.positions[mesh.vertices("skin")] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = locks("female")[1].T
    before = (forward > -0.8) & (forward < -0.5) & (up < 0.2) & (up > -0.7)
    for side in (left > 0.0, left < 0.0):
        assert (before & side).sum() > 8
        away, _ = scipy.spatial.cKDTree(skin).query(locks("female")[1][before & side])
        assert np.percentile(away, 25) < 0.13
