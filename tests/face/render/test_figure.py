from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.display import DisplayError
from kinesic.face.render.figure import STANDING, FigurePortrait, figure_preset
from kinesic.face.render.presets import DRAFT, FULL, NORMAL

SKELETON = Robot.load("human").skeleton
SIZE = (160, 200)


@pytest.fixture(scope="module")
def figure(drawable: None) -> Iterator[FigurePortrait]:
    with FigurePortrait(SKELETON, preset=DRAFT, size=SIZE) as opened:
        yield opened


def posture(**degrees: float) -> np.ndarray:
    found = SKELETON.rest.copy()
    for name, angle in degrees.items():
        found[SKELETON.joint(name)] = np.radians(angle)
    return found


def seen(figure: FigurePortrait, angles: np.ndarray) -> np.ndarray:
    """(height, width) parts, first row on top: 0 background, 1 skin, 6 cloth."""
    figure.draw(angles, {}, STANDING)
    with figure.pipeline.geometry.context:
        return figure.pipeline.geometry.parts()


def test_it_stands_dressed_from_head_to_foot(figure: FigurePortrait):
    parts = seen(figure, SKELETON.rest)
    rows = np.flatnonzero((parts > 0).any(axis=1))
    assert 0.75 < (rows[-1] - rows[0]) / SIZE[1] < 0.98
    assert (parts == 6).sum() > 3 * (parts == 1).sum() > 0
    assert (parts[: rows[0] + 15] == 6).sum() == 0  # no cloth on the head
    assert (parts[rows[-1] - 40 :] == 1).sum() == 0  # no bare feet


def test_a_raised_arm_is_seen_where_it_is(figure: FigurePortrait):
    parts = seen(figure, posture(l_shoulder_abduct=90, l_elbow_flexion=0))
    columns = np.flatnonzero((parts[45:65] > 0).any(axis=0))
    assert columns.max() > 0.9 * SIZE[0]  # her left is to the right of the picture
    assert columns.min() > 0.25 * SIZE[0]


def test_the_face_moves(figure: FigurePortrait):
    still, smiling = (figure.draw(SKELETON.rest, units, STANDING).astype(int) for units in ({}, {"26": 1.0, "12": 1.0}))
    changed = np.flatnonzero((np.abs(still - smiling) > 12).any(axis=(1, 2)))
    assert len(changed)
    assert changed.max() < 0.3 * SIZE[1]  # first row on top


def test_it_is_drawn_the_same_twice(figure: FigurePortrait):
    first = figure.draw(posture(l_elbow_flexion=90), {"1": 0.5})
    figure.draw(SKELETON.rest, {})
    np.testing.assert_array_equal(figure.draw(posture(l_elbow_flexion=90), {"1": 0.5}), first)


def test_shadow_and_occlusion_reach_the_whole_figure(drawable: None):
    with FigurePortrait(SKELETON, preset=DRAFT, size=SIZE) as plain, FigurePortrait(SKELETON, size=SIZE) as shaded:
        hanging = posture(l_elbow_flexion=100, r_elbow_flexion=100)
        darker = plain.draw(hanging, {}, STANDING).astype(int) - shaded.draw(hanging, {}, STANDING)
    assert (darker[50:110] > 20).any()  # under the arms
    assert (darker[110:] > 6).any()  # on the legs, which are dark


def test_presets_are_widened():
    normal, full = figure_preset(NORMAL), figure_preset(FULL)
    assert normal.shadow is not None
    assert normal.shadow.reach == 1.0
    assert full.focus is None
    assert figure_preset(DRAFT) == DRAFT


def test_sizes_and_cameras_have_limits(drawable: None):
    with pytest.raises(DisplayError, match="each side may be 1 to 4096"):
        FigurePortrait(SKELETON, size=(5000, 10))
    with pytest.raises(DisplayError, match=r"it may be 0\.3 to 7 m away"):
        replace(STANDING, distance=8.0)


def test_a_shadow_of_clothes_ends_where_they_do(drawable: None):
    """What is cut off a collar or a sleeve shades neither neck nor hand."""
    preset = replace(DRAFT, shadow=NORMAL.shadow, coarse=1)
    with FigurePortrait(SKELETON, preset=preset, size=SIZE) as whole:
        shaded = whole.draw(SKELETON.rest, {}, STANDING).astype(int)
        geometry = whole.pipeline.geometry
        with geometry.context:
            skin = geometry.parts() == 1
    with FigurePortrait(SKELETON, preset=DRAFT, size=SIZE) as plain:
        lit = plain.draw(SKELETON.rest, {}, STANDING).astype(int)
    darker = (lit - shaded).max(axis=2) > 15
    assert 0.0 < darker[skin].mean() < 0.09
