from dataclasses import replace
from functools import cache
from math import degrees

import numpy as np
import pytest

from kinesic.bench.naturalness.legibility import ALIKE_DISTANCE
from kinesic.bench.naturalness.lexicon import measure_gesture, measure_place
from kinesic.bench.naturalness.likeness import measure_appearance, nearest_pairs
from kinesic.bench.naturalness.places import measure_place_distance
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.legibility_table import PlaceTable, legibility_table
from kinesic.expressivity.variation import Variation
from kinesic.studies.gestures.isolated import plan_gesture

ROBOT = Robot.load()
REQUIRED_POSITIONS = legibility_table().places


@pytest.fixture(scope="module")
def plan_alone(known):
    """Return a function that plans a gesture alone, once for all tests."""
    return cache(lambda name: plan_gesture(known.lexicon.forms_by_id[name], known))


def sample_stroke(planned, count=1):
    """Return `count` postures of a stroke, or the posture at its main sync point."""
    times = {sync.sync: planned.trajectory.zero + sync.planned for sync in planned.syncs}
    spread = [times["stroke"]] if count == 1 else np.linspace(times["strokeStart"], times["strokeEnd"], count)
    return planned.trajectory.sample(np.array(spread))[0]


@pytest.mark.soak
def test_hands_of_gestures_are_at_their_required_positions(plan_alone, known):
    forms = known.lexicon.forms_by_id
    distances = {name: measure_place(forms[name], plan_alone(name)) for name in REQUIRED_POSITIONS}
    assert [name for name, distance in distances.items() if not 0.0 < distance <= REQUIRED_POSITIONS[name].within] == []


@pytest.mark.parametrize("name", ["adjust_cuff", "watch_time", "cry", "me", "photo"])
def test_hands_of_randomly_varied_gestures_are_at_their_required_positions(known, name):
    form, varied = known.lexicon.forms_by_id[name], replace(known, variation=Variation(1.0, 2))
    assert measure_place(form, plan_gesture(form, varied)) <= REQUIRED_POSITIONS[name].within


@pytest.mark.soak
def test_stop_gesture_is_at_arms_length_in_front_of_the_chest(plan_alone):
    frames = ROBOT.skeleton.frames(sample_stroke(plan_alone("stop"))[0])
    direction = frames.origins[ROBOT.arm("r").wrist] - frames.origins[ROBOT.arm("r").shoulder]
    assert np.linalg.norm(direction) >= 0.85 * ROBOT.arm_length
    assert abs(frames.origins[ROBOT.arm("r").wrist][1]) <= 0.06


def test_violin_gesture_holds_the_left_hand_out_and_turns_the_head_to_it(plan_alone):
    frames = ROBOT.skeleton.frames(sample_stroke(plan_alone("violin"))[0])
    left = ROBOT.arm("l")
    assert np.linalg.norm(frames.origins[left.wrist] - frames.origins[left.shoulder]) > 0.65 * ROBOT.arm_length
    face = frames.rotations[ROBOT.skeleton.segment(ROBOT.chains["neck"][-1])][:, 0]
    assert degrees(np.arctan2(face[1], face[0])) > 15


@pytest.mark.parametrize("name", legibility_table().shoulders)
def test_shoulders_rise_in_shrugging_gestures(known, name):
    assert degrees(measure_gesture(known.lexicon.forms_by_id[name], known).body.shoulders) >= 12


def test_think_and_phone_call_gestures_differ_in_the_elbow_position(plan_alone):
    difference = measure_appearance(ROBOT, sample_stroke(plan_alone("think"), 60)) - measure_appearance(
        ROBOT, sample_stroke(plan_alone("phone_call"), 60)
    )
    distances = np.sqrt((difference**2).sum(axis=-1).mean(axis=0))
    assert distances[4] > 0.07, "the right elbow"
    assert distances.max() > 0.08


def test_error_of_a_required_position_is_measured_at_the_performing_hand(known):
    form = known.lexicon.forms_by_id["phone_call"]
    right, left = (measure_place(form, plan_gesture(form, known, mode)) for mode in ("right", "left"))
    assert left == pytest.approx(right, abs=0.005)


@pytest.mark.soak
def test_gestures_with_the_hand_at_the_head_do_not_look_alike(plan_alone):
    seen = {
        name: measure_appearance(ROBOT, sample_stroke(plan_alone(name), 60))
        for name in REQUIRED_POSITIONS
        if not REQUIRED_POSITIONS[name].at.startswith("other")
    }
    assert nearest_pairs(seen, ALIKE_DISTANCE) == []


@pytest.mark.parametrize("name", ["applause", "prayer", "cry", "despair", "photo", "gasp", "pride", "akimbo"])
def test_arm_angles_of_symmetric_gestures_are_mirror_images(plan_alone, name):
    angles = sample_stroke(plan_alone(name))[0]
    left, right = (angles[list(ROBOT.arm(side).joints)] for side in "lr")
    assert degrees(np.abs(left - right).max()) < 3


def test_required_hand_positions_on_the_face_rotate_with_the_head():
    requirement = PlaceTable("tips", "mouth", 0.1)
    rest, turned = ROBOT.skeleton.rest, ROBOT.skeleton.rest.copy()
    turned[ROBOT.skeleton.names.index("skullbase_torsion")] = -0.5
    right, left = (measure_place_distance(ROBOT, turned, side, requirement) for side in "rl")
    assert right < measure_place_distance(ROBOT, rest, "r", requirement) < left


def distance_change(place, joint):
    """Return the change of the left palm's distance [m] when one joint rotates."""
    requirement, angles = PlaceTable("palm", place, 0.1), ROBOT.skeleton.rest.copy()
    still = measure_place_distance(ROBOT, angles, "l", requirement)
    angles[ROBOT.skeleton.names.index(joint)] += 0.5
    return measure_place_distance(ROBOT, angles, "l", requirement) - still


def test_required_hand_positions_follow_their_body_part():
    assert distance_change("chest", "vl5_tilt") == pytest.approx(distance_change("belly", "vl5_tilt"), abs=1e-9)
    assert distance_change("chest", "vl5_tilt") == pytest.approx(0.0, abs=1e-9)
    assert abs(distance_change("hip", "vl5_tilt")) > 0.003
    assert abs(distance_change("other wrist", "r_shoulder_flexion")) > 0.003
    assert distance_change("other wrist", "r_wrist_flexion") == pytest.approx(0.0, abs=1e-9)
    assert abs(distance_change("other palm", "r_wrist_flexion")) > 0.003
    assert distance_change("other forearm", "r_elbow_twisting") == pytest.approx(0.0, abs=1e-9)
    assert distance_change("other shoulder", "r_elbow_flexion") == pytest.approx(0.0, abs=1e-9)


def test_required_ear_eye_and_hip_positions_are_mirrored_for_the_other_hand():
    for place in ("ear", "eye", "hip"):
        requirement = PlaceTable("palm", place, 0.1)
        left, right = (measure_place_distance(ROBOT, ROBOT.skeleton.rest, side, requirement) for side in "lr")
        assert left == pytest.approx(right), place
