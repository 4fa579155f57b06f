"""Hair grows out of the skull, stays outside it, and leaves the face free."""

from functools import cache

import numpy as np
import pytest
import scipy

from kinesic.body.choices import Variant
from kinesic.face.assets.chart import hair
from kinesic.face.assets.hair import CUT, EARS, INSIDE, STYLES, Locks, grow
from kinesic.face.assets.mesh import VARIANTS, load_head


@cache
def locks(variant: Variant) -> tuple[Locks, np.ndarray]:
    """Hair, and where it is in distances between the eyes."""
    mesh = load_head(variant)
    found = grow(mesh, STYLES[variant])
    return found, found.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])


def edges(variant: Variant) -> np.ndarray:
    """(locks, along, 2 edges, 3) of them."""
    return locks(variant)[1].reshape(-1, STYLES[variant].steps + 1, 2, 3)


def lengths(variant: Variant) -> np.ndarray:
    """(locks, steps) along their middles."""
    return np.linalg.norm(np.diff(edges(variant).mean(axis=2), axis=1), axis=2)


@pytest.mark.parametrize("variant", VARIANTS)
def test_hair_covers_the_skull_and_not_the_face(variant: Variant):
    found, (forward, left, up) = locks(variant)[0], locks(variant)[1].T
    assert np.isfinite(found.positions).all()
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0)
    assert not ((forward > 0.0) & (np.abs(left) < 0.9) & (up > -2.0) & (up < 0.8)).any()
    for place in ((-0.6, 0.8, 0.9), (-1.2, -0.9, 0.8), (-2.9, 0.0, 0.4), (-1.1, 0.2, 1.7)):
        assert np.linalg.norm(locks(variant)[1] - place, axis=1).min() < 0.5, place


@pytest.mark.parametrize("variant", VARIANTS)
def test_hair_is_outside_the_head(variant: Variant):
    mesh = load_head(variant)
    skin = mesh.positions[mesh.vertices("skin")] / (mesh.eyes[0, 1] - mesh.eyes[1, 1]) - INSIDE
    far = np.linalg.norm(skin, axis=1)
    spokes = locks(variant)[1] - INSIDE
    away = np.linalg.norm(spokes, axis=1)
    nearest = (spokes / away[:, None] @ (skin / far[:, None]).T).argmax(axis=1)
    high = locks(variant)[1][:, 2] > 0.0
    assert np.mean(away[high] > far[nearest][high] - 0.03) > 0.97


@pytest.mark.parametrize("variant", VARIANTS)
def test_locks_are_seen_from_outside_and_those_that_hang_from_inside_too(variant: Variant):
    found, _ = locks(variant)
    for triangles, outward in ((found.triangles, 1.0), (found.inside, -1.0)):
        a, b, c = found.positions[triangles].transpose(1, 0, 2)
        facing = outward * np.einsum("ti,ti->t", np.cross(b - a, c - a), found.normals[triangles[:, 0]]) > 0.0
        assert facing.mean() > 0.95
    assert len(found.inside) < 0.8 * len(found.triangles)
    each = found.inside[:, 0] // (2 * (STYLES[variant].steps + 1))
    assert set(np.unique(each, return_counts=True)[1]) == {2 * STYLES[variant].steps}  # else it begins in a step
    assert found.places[:, 0].min() == -1.0
    assert found.places[:, 0].max() == 1.0


def test_the_two_styles_differ_in_length():
    woman, man = (locks(variant)[1] for variant in VARIANTS)
    assert woman[:, 2].min() < -1.3
    assert man[:, 2].min() > -0.9


def test_hair_is_the_same_every_time():
    mesh = load_head("male")
    np.testing.assert_array_equal(grow(mesh, STYLES["male"]).positions, locks("male")[0].positions)


@pytest.mark.parametrize(("variant", "tip"), [("female", 0.2), ("male", 0.05)])
def test_locks_begin_narrow_at_the_hairline_and_do_not_end_in_a_point(variant: Variant, tip: float):
    """Wide roots are steps along the hairline, and thin tips are dots in small pictures."""
    points = edges(variant)
    widths = np.linalg.norm(points[:, :, 0] - points[:, :, 1], axis=2) / (2.0 * STYLES[variant].width[0])
    first = hair(points[:, 0].mean(axis=1)) < 0.08
    assert first.sum() > 5
    assert widths[first, 0].max() < 0.75
    assert widths[:, -1].min() > tip


def test_short_hair_lies_on_the_neck_and_has_no_scales():
    """Locks there are several times as long as wide, and their tips do not stand off."""
    mesh = load_head("male")
    skin = mesh.positions[mesh.vertices("skin")] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    tips = edges("male")[:, -1].mean(axis=1)
    away, _ = scipy.spatial.cKDTree(skin).query(tips[tips[:, 2] < -0.3])
    assert np.percentile(away, 90) < 0.16
    low = edges("male")[:, 0, 0, 2] < 0.1
    widths = np.linalg.norm(edges("male")[low, :, 0] - edges("male")[low, :, 1], axis=2).max(axis=1)
    assert np.median(widths / lengths("male")[low].sum(axis=1)) < 0.35


def test_the_crown_is_covered():
    """Rays from inside the head meet a lock wherever it has hair behind the forehead."""
    ways = np.random.default_rng(3).standard_normal((1200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    crown = ways[(ways[:, 2] > 0.5) & (ways[:, 0] < 0.1)]
    a, b, c = (locks("female")[1][locks("female")[0].triangles] - INSIDE).transpose(1, 0, 2)
    within = [crown @ np.cross(one, other).T > 0.0 for one, other in ((b, c), (c, a), (a, b))]
    assert np.all(within, axis=0).any(axis=1).mean() > 0.93


def test_long_hair_rises_gently_over_the_ears():
    middles = edges("female").mean(axis=2)
    rises = np.diff(np.linalg.norm(middles - INSIDE, axis=2), axis=1) / lengths("female")
    beside = (np.abs(middles[:, 1:, 1]) > 0.9) & (middles[:, 1:, 2] < 0.5) & (middles[:, 1:, 2] > -0.6)
    assert np.percentile(rises[beside], 90) < 0.35


def test_short_hair_goes_round_the_ears():
    forward, left, up = np.moveaxis(edges("male").mean(axis=2), -1, 0)
    back, front, low, high, aside = EARS
    assert not ((forward > back) & (forward < front) & (up > low) & (up < high) & (np.abs(left) > aside)).any()


@pytest.mark.parametrize("variant", VARIANTS)
def test_locks_end_where_they_are_cut(variant: Variant):
    assert edges(variant).mean(axis=2)[:, :, 2].min() > STYLES[variant].cut + CUT[0] - 1e-9
