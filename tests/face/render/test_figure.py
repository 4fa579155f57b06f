from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.display import DisplayError
from kinesic.face.render.figure import STANDING_CAMERA, FigurePortrait, scale_preset_to_figure
from kinesic.face.render.presets import DRAFT_PRESET, FULL_PRESET, NORMAL_PRESET

HUMAN_SKELETON = Robot.load("human").skeleton
PICTURE_SIZE = (160, 200)


@pytest.fixture(scope="module")
def figure(drawable: None) -> Iterator[FigurePortrait]:
    with FigurePortrait(HUMAN_SKELETON, preset=DRAFT_PRESET, size=PICTURE_SIZE) as opened:
        yield opened


def posture(**degrees: float) -> np.ndarray:
    actual = HUMAN_SKELETON.rest.copy()
    for name, angle in degrees.items():
        actual[HUMAN_SKELETON.joint(name)] = np.radians(angle)
    return actual


def seen(figure: FigurePortrait, angles: np.ndarray) -> np.ndarray:
    """Return the (height, width) parts, top row first.

    0 is the background, 1 skin, 6 cloth.
    """
    figure.draw(angles, {}, STANDING_CAMERA)
    with figure.pipeline.geometry.context:
        return figure.pipeline.geometry.parts()


def test_figure_is_dressed_from_head_to_foot(figure: FigurePortrait):
    parts = seen(figure, HUMAN_SKELETON.rest)
    rows = np.flatnonzero((parts > 0).any(axis=1))
    assert 0.75 < (rows[-1] - rows[0]) / PICTURE_SIZE[1] < 0.98
    assert (parts == 6).sum() > 3 * (parts == 1).sum() > 0
    assert (parts[: rows[0] + 15] == 6).sum() == 0  # no cloth on the head
    assert (parts[rows[-1] - 40 :] == 1).sum() == 0  # no bare feet


def test_raised_left_arm_appears_on_the_right_of_the_picture(figure: FigurePortrait):
    parts = seen(figure, posture(l_shoulder_abduct=90, l_elbow_flexion=0))
    columns = np.flatnonzero((parts[45:65] > 0).any(axis=0))
    assert columns.max() > 0.9 * PICTURE_SIZE[0]  # her left is to the right of the picture
    assert columns.min() > 0.25 * PICTURE_SIZE[0]


def test_smile_and_jaw_drop_change_only_the_top_30_percent_of_the_figure_picture(figure: FigurePortrait):
    still, smiling = (
        figure.draw(HUMAN_SKELETON.rest, units, STANDING_CAMERA).astype(int) for units in ({}, {"26": 1.0, "12": 1.0})
    )
    changed = np.flatnonzero((np.abs(still - smiling) > 12).any(axis=(1, 2)))
    assert len(changed)
    assert changed.max() < 0.3 * PICTURE_SIZE[1]  # first row on top


def test_figure_drawing_is_deterministic(figure: FigurePortrait):
    first = figure.draw(posture(l_elbow_flexion=90), {"1": 0.5})
    figure.draw(HUMAN_SKELETON.rest, {})
    np.testing.assert_array_equal(figure.draw(posture(l_elbow_flexion=90), {"1": 0.5}), first)


def test_shadow_and_occlusion_darken_the_torso_and_the_legs(drawable: None):
    with (
        FigurePortrait(HUMAN_SKELETON, preset=DRAFT_PRESET, size=PICTURE_SIZE) as plain,
        FigurePortrait(HUMAN_SKELETON, size=PICTURE_SIZE) as shaded,
    ):
        hanging = posture(l_elbow_flexion=100, r_elbow_flexion=100)
        darker = plain.draw(hanging, {}, STANDING_CAMERA).astype(int) - shaded.draw(hanging, {}, STANDING_CAMERA)
    assert (darker[50:110] > 20).any()  # below the arms
    assert (darker[110:] > 6).any()  # on the legs, which are dark


def test_quality_preset_lengths_are_adapted_to_whole_figures():
    normal, full = scale_preset_to_figure(NORMAL_PRESET), scale_preset_to_figure(FULL_PRESET)
    assert normal.shadow is not None
    assert normal.shadow.reach == 1.0
    assert full.focus is None
    assert scale_preset_to_figure(DRAFT_PRESET) == DRAFT_PRESET


def test_picture_size_and_camera_distance_beyond_their_limits_are_rejected(drawable: None):
    with pytest.raises(DisplayError, match="use 1 to 4096 per side"):
        FigurePortrait(HUMAN_SKELETON, size=(5000, 10))
    with pytest.raises(DisplayError, match=r"use 0\.3 to 7 m"):
        replace(STANDING_CAMERA, distance=8.0)


def test_clothes_cast_shadow_on_less_than_9_percent_of_the_skin(drawable: None):
    """Expect no shadow of the omitted parts of collar and sleeves."""
    preset = replace(DRAFT_PRESET, shadow=NORMAL_PRESET.shadow, coarse=1)
    with FigurePortrait(HUMAN_SKELETON, preset=preset, size=PICTURE_SIZE) as whole:
        shaded = whole.draw(HUMAN_SKELETON.rest, {}, STANDING_CAMERA).astype(int)
        geometry = whole.pipeline.geometry
        with geometry.context:
            skin = geometry.parts() == 1
    with FigurePortrait(HUMAN_SKELETON, preset=DRAFT_PRESET, size=PICTURE_SIZE) as plain:
        lit = plain.draw(HUMAN_SKELETON.rest, {}, STANDING_CAMERA).astype(int)
    darker = (lit - shaded).max(axis=2) > 15
    assert 0.0 < darker[skin].mean() < 0.09
