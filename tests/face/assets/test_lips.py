"""Tests of contact between the lips without penetration."""

import numpy as np
import pytest

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.body.utterance import Phoneme
from kinesic.expressivity.face.visemes import viseme_of, visemes
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.lips import ASIDE_SLOPE, Lips, find_lips
from kinesic.face.assets.mesh import FACE_VARIANTS, MESH_PARTS, Mesh, load_head
from kinesic.face.assets.paint import MOUTH_LINE

CORNER_COLUMNS = 3  # columns in each corner of the mouth


@pytest.fixture(scope="module", params=FACE_VARIANTS)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head(request.param)


@pytest.fixture(scope="module")
def mouth(mesh: Mesh) -> Lips:
    return find_lips(mesh)


def overlap(mouth: Lips, positions: np.ndarray) -> np.ndarray:
    """Return the overlap of the lips from corner to corner [mm]."""
    return 1000.0 * mouth.overlap(positions)[CORNER_COLUMNS:-CORNER_COLUMNS]


@pytest.mark.parametrize("wide", [0.3, 1.0, 1.6])
def test_lip_edge_heights_in_vertical_strips_match_a_brute_force_reference(mouth: Lips, wide: float):
    """Compare lips narrower than, as wide as and wider than all columns."""
    random, half = np.random.default_rng(5), 0.5 * (mouth.middles[1] - mouth.middles[0])
    points = random.uniform(wide * mouth.middles[0], wide * mouth.middles[-1], len(mouth.outward))
    away = random.uniform(-0.01, 0.01, len(points))
    for end, upper in zip(mouth._measure_column_edges(points, away), (True, False), strict=True):
        some = points[(mouth.outward > 0.0) == upper]
        columns = [np.clip(mouth.middles + side * half, some.min(), some.max())[:, None] for side in (-1, 1)]
        aside = np.maximum(np.maximum(columns[0] - some, some - columns[1]), 0.0)
        expected = (away[(mouth.outward > 0.0) == upper] + ASIDE_SLOPE * aside).min(axis=1)
        np.testing.assert_allclose(end, expected, atol=1e-12)


def test_lips_of_the_neutral_face_touch_along_their_whole_width(mesh: Mesh, mouth: Lips):
    actual = overlap(mouth, mesh.positions)
    assert actual.min() > 0.0
    assert np.median(actual) < 0.8
    assert actual.max() < 2.5


@pytest.mark.parametrize("subdivided", [False, True])
def test_smile_of_tiny_intensity_moves_no_vertex_noticeably(mesh: Mesh, subdivided: bool):
    head = mesh.subdivided() if subdivided else mesh
    moved = np.linalg.norm(deform(head, {"12": 1e-6}) - deform(head, {}), axis=1)
    assert moved.max() < 1e-6


@pytest.mark.parametrize("jaw", [0.0, 0.4, 1.0])
def test_pressed_lips_touch_and_overlap_by_less_than_2_5_mm(mesh: Mesh, mouth: Lips, jaw: float):
    actual = overlap(mouth, deform(mesh, {"24": 1.0, "25": 1.0, "26": jaw}))
    assert actual.min() > 0.0
    assert actual.max() < 2.5


def test_random_expressions_overlap_the_lips_by_less_than_4_mm(mesh: Mesh, mouth: Lips):
    random = np.random.default_rng(4)
    for _ in range(40):
        shown = {name: float(random.uniform()) for name in random.choice(FACE_CHANNELS, 6, replace=False)}
        assert overlap(mouth, deform(mesh, shown)).max() < 4.0, shown


def test_lip_gap_grows_with_lips_part_intensity(mesh: Mesh, mouth: Lips):
    opened = [-overlap(mouth, deform(mesh, {"25": fraction})).min() for fraction in np.linspace(0.0, 1.0, 6)]
    assert np.all(np.diff(opened) > 0.1)
    assert np.all(np.diff(opened)[1:] > 0.7)
    assert 3.0 < opened[-1] < 8.0


def test_smiling_lips_stay_closed_unless_the_lips_part_unit_opens_them(mesh: Mesh, mouth: Lips):
    assert overlap(mouth, deform(mesh, {"12": 1.0})).min() > 0.0
    assert overlap(mouth, deform(mesh, {"12": 1.0, "25": 0.5})).min() < -4.0


def test_viseme_w_differs_visibly_from_the_vowel_in_you(mesh: Mesh, mouth: Lips):
    """Expect a mouth narrower, less open and further forward by millimetres."""
    unit, rest = mesh.eyes[0, 1] - mesh.eyes[1, 1], mesh.positions
    front = (mesh.parts == MESH_PARTS.index("skin")) & (rest[:, 0] > 0.0)
    around = front & (np.abs(rest[:, 2] / unit - MOUTH_LINE) < 0.15) & (np.abs(rest[:, 1] / unit) < 0.45)
    w, you = (deform(mesh, viseme_of(sound).units) for sound in "wu")
    wide = [1000.0 * float(np.ptp(item[around, 1])) for item in (rest, w, you)]
    ahead = [1000.0 * float(item[around, 0].max()) for item in (rest, w, you)]
    assert wide[1] + 1.5 < wide[2] < wide[0] - 6.0
    assert ahead[1] - 1.5 > ahead[2] > ahead[0] + 4.0
    assert overlap(mouth, w).min() > overlap(mouth, you).min() + 1.0
    assert overlap(mouth, w).min() < -0.5  # open


def test_tightened_and_sucked_lips_overlap_more_than_at_rest(mesh: Mesh, mouth: Lips):
    middle = slice(8, 17)
    plain = overlap(mouth, deform(mesh, {}))[middle]
    for unit in ("23", "28"):
        rolled = overlap(mouth, deform(mesh, {unit: 1.0}))[middle]
        assert rolled.min() > plain.min() + 0.3  # [mm]


@pytest.mark.parametrize("sounds", [("a", "m", "a"), ("m", "pf", "e")], ids="".join)
def test_lip_gap_changes_slower_than_300_mm_per_second_around_a_closure(
    mesh: Mesh, mouth: Lips, sounds: tuple[str, ...]
):
    phonemes = [Phoneme(sound, 0.2 + 0.08 * k, 0.08) for k, sound in enumerate(sounds)]
    times = np.arange(0.2, 0.55, 0.01)
    shown = visemes(phonemes, times)
    rows = ({unit: float(values[k]) for unit, values in shown.items()} for k in range(len(times)))
    gaps = np.array([overlap(mouth, deform(mesh, row)).min() for row in rows])
    assert gaps.max() > 0.0  # [mm] closed
    assert np.abs(np.diff(gaps)).max() / 0.01 < 300.0  # [mm/s]
