"""Single gestures: plan, pictures and vocabulary."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread

from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.report.silhouette import PALE_COLOUR, depth, fade_lines, hand_outline, project, silhouette
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import (
    STROKE_TIME,
    key_postures,
    plan_gesture,
    stroke_error,
    write_isolated_gesture,
)
from kinesic.studies.gestures.sheet import draw_gesture_sheet, draw_strip
from kinesic.studies.gestures.vocabulary import list_vocabulary


@pytest.fixture(scope="module")
def waved(known):
    form = known.lexicon.find("greet_wave").form
    return key_postures(form, plan_gesture(form, known), 6)


def test_single_gesture_has_its_stroke_at_the_requested_time(known):
    planned = plan_gesture(known.lexicon.find("offer").form, known, "left")
    assert abs(stroke_error(planned)) < 0.01
    assert planned.keyframes.uses["gesture"] == {"l_hand"}
    assert next(sync.requested for sync in planned.syncs if sync.sync == "stroke") == STROKE_TIME


def test_gesture_name_is_escaped_in_xml():
    assert 'lexeme="a&lt;b"' in write_isolated_gesture("a<b").replace("'", '"')


def test_wave_gesture_has_two_to_six_key_postures_and_a_palm_path_of_the_right_hand_only(waved, known):
    assert 2 <= len(waved.postures) <= 6
    assert set(waved.paths) == {"r"}
    palm = waved.paths["r"]
    assert np.all(palm[:, 1] < 0)
    assert np.ptp(palm[:, 1]) > 0.05
    wrist = known.robot.skeleton.frames(waved.postures[waved.stroke]).origins[known.robot.skeleton.segment("r_wrist")]
    assert np.linalg.norm(palm - wrist, axis=1).min() < 0.09


def test_each_key_posture_of_a_gesture_has_facial_action_units(known):
    form = known.lexicon.find("disgust").form
    shown = key_postures(form, plan_gesture(form, known), 6)
    assert len(shown.faces) == len(shown.postures)
    assert shown.faces[shown.stroke].keys() >= {"L9", "R9"}  # wrinkled nose
    assert not any(unit.endswith("45") for face in shown.faces for unit in face)


def test_pictures_of_a_gesture_skip_keys_that_move_only_fingers():
    """Plan a gesture with key frames of the fingers between arm keys."""
    human = set_up("human")
    form, skeleton = human.lexicon.find("disgust").form, human.robot.skeleton
    shown = key_postures(form, plan_gesture(form, human), 6)
    wrists = skeleton.frames(np.array(shown.postures)).origins[:, skeleton.segment("r_wrist")]
    resting = skeleton.frames(skeleton.rest).origins[skeleton.segment("r_wrist")]
    assert np.linalg.norm(wrists - resting, axis=1).min() > 0.2
    assert len(shown.postures) == len(shown.faces) == 2


@pytest.mark.parametrize("most", [2, 3, 6])
def test_gesture_pictures_with_few_postures_include_the_stroke(known, most):
    form = known.lexicon.find("spiral_stairs").form
    planned = plan_gesture(form, known)
    shown = key_postures(form, planned, most)
    stroke = next(posture for posture in planned.postures.postures if ("gesture", "stroke") in posture.syncs)
    assert len(shown.postures) <= most
    drawn, keyed = shown.postures[shown.stroke], np.array(stroke.keyed)
    assert np.array_equal(drawn[keyed], stroke.angles[keyed])
    np.testing.assert_allclose(drawn, stroke.angles, atol=0.01)


def test_nearer_lines_of_a_robot_drawing_are_drawn_later_and_darker(known):
    lines = silhouette(known.robot, known.robot.skeleton.rest, {})
    depths = [line.depth for line in lines if line.owner]
    assert depths == sorted(depths)
    arm = [line for line in lines if line.owner == "r"]
    near, far = max(arm, key=lambda line: line.depth), min(arm, key=lambda line: line.depth)
    assert sum(near.colour) <= sum(far.colour)
    assert all(line.colour == PALE_COLOUR for line in fade_lines(lines))


def test_front_view_draws_the_left_side_of_the_robot_on_the_right():
    assert project(np.array([0.0, 1.0, 0.0])) == pytest.approx([1.0, 0.0])
    assert project(np.array([0.0, 0.0, 1.0]))[1] > 0.9
    assert depth(np.array([1.0, 0.0, 0.0])) > 0.9


def test_drawn_fingers_bend_towards_the_palm(known):
    site = known.robot.sites["l_palm"]
    flat, fist = (hand_outline(known.robot, "l", hand_shapes()[name]) for name in ("flat", "fist"))
    for (straight, _), (bent, _) in list(zip(flat, fist, strict=True))[1:5]:
        assert np.linalg.norm(straight[-1] - straight[0]) > np.linalg.norm(bent[-1] - bent[0])
        assert (straight[-1] - straight[0]) @ site.facing == pytest.approx(0.0, abs=1e-9)
        assert (bent[1] - bent[0]) @ site.facing > 0


def test_thumbs_of_drawn_hands_are_mirrored(known):
    left, right = (hand_outline(known.robot, side, hand_shapes()["thumb"])[-1][0] for side in ("l", "r"))
    assert left == pytest.approx(right * [1, -1, 1], abs=1e-9)


def test_gesture_pictures_are_not_empty(waved, known, tmp_path):
    drawn = draw_strip(waved, known.robot, tmp_path / "wave.png", says="The raised hand waves: hello.")
    pixels = imread(drawn)
    assert pixels.shape[1] > pixels.shape[0] > 100
    assert (pixels[..., :3].min(axis=-1) < 0.9).mean() > 0.03
    other = replace(waved, form=replace(waved.form, id="other", category="beat"))
    whole = draw_gesture_sheet([waved, other], known.robot, tmp_path / "sheet.png")
    assert imread(whole).shape[1] > imread(whole).shape[0]
    assert draw_gesture_sheet([waved], known.robot, tmp_path / "sheet.svg").read_text().startswith("<?xml")


def test_gesture_pictures_are_reproducible(waved, known, tmp_path):
    one, two = (draw_strip(waved, known.robot, tmp_path / f"{name}.png").read_bytes() for name in "ab")
    assert one == two


def test_vocabulary_lists_every_gesture_sorted_with_a_short_description_and_meanings(known):
    entries = list_vocabulary(known.lexicon, known.pace)
    assert [(entry.category, entry.id) for entry in entries] == sorted((entry.category, entry.id) for entry in entries)
    assert len({entry.says for entry in entries}) == len(entries) >= 150
    for entry in entries:
        assert 10 < len(entry.says) < 90
        assert entry.says.endswith((".", "!"))
        assert entry.meanings
        assert set(entry.hands) <= {"left", "right"}
        assert 0.0 < entry.stroke_s < entry.whole_s < 10.0
