from dataclasses import replace
from math import degrees

import numpy as np
import pytest

from kinesic.bench.naturalness.legibility import TOO_NEAR
from kinesic.bench.naturalness.lexicon import measure_gesture, measure_place
from kinesic.bench.naturalness.likeness import measure_appearance, nearest_pairs
from kinesic.bench.naturalness.places import place_distance
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.legibility_table import PlaceTable, legibility_table
from kinesic.expressivity.variation import Variation
from kinesic.studies.gestures.isolated import plan_gesture

ROBOT = Robot.load()
PLACES = legibility_table().places


@pytest.fixture(scope="module")
def plans(known):
    """All gestures that need a place, each alone."""
    return {name: plan_gesture(known.lexicon.forms_by_id[name], known) for name in PLACES}


def stroke(planned, count=1):
    """(count, n) [rad] from strokeStart to strokeEnd, or at the stroke."""
    times = {sync.sync: planned.trajectory.zero + sync.planned for sync in planned.syncs}
    spread = [times["stroke"]] if count == 1 else np.linspace(times["strokeStart"], times["strokeEnd"], count)
    return planned.trajectory.sample(np.array(spread))[0]


def test_hands_are_where_their_meaning_needs_them(plans, known):
    away = {name: measure_place(known.lexicon.forms_by_id[name], planned) for name, planned in plans.items()}
    assert [name for name, distance in away.items() if not 0.0 < distance <= PLACES[name].within] == []


@pytest.mark.parametrize("name", ["adjust_cuff", "watch_time", "cry", "me", "photo"])
def test_hands_are_there_too_where_gestures_vary(known, name):
    form, varied = known.lexicon.forms_by_id[name], replace(known, variation=Variation(1.0, 2))
    assert measure_place(form, plan_gesture(form, varied)) <= PLACES[name].within


def test_a_stop_is_at_arms_length_before_the_chest(plans):
    frames = ROBOT.skeleton.frames(stroke(plans["stop"])[0])
    way = frames.origins[ROBOT.arm("r").wrist] - frames.origins[ROBOT.arm("r").shoulder]
    assert np.linalg.norm(way) >= 0.85 * ROBOT.arm_length
    assert abs(frames.origins[ROBOT.arm("r").wrist][1]) <= 0.06


def test_a_violin_is_held_out_and_the_head_turns_to_it(plans):
    frames = ROBOT.skeleton.frames(stroke(plans["violin"])[0])
    left = ROBOT.arm("l")
    assert np.linalg.norm(frames.origins[left.wrist] - frames.origins[left.shoulder]) > 0.65 * ROBOT.arm_length
    face = frames.rotations[ROBOT.skeleton.segment(ROBOT.chains["neck"][-1])][:, 0]
    assert degrees(np.arctan2(face[1], face[0])) > 15


@pytest.mark.parametrize("name", legibility_table().shoulders)
def test_shoulders_rise_where_that_is_the_gesture(known, name):
    assert degrees(measure_gesture(known.lexicon.forms_by_id[name], known).body.shoulders) >= 12


def test_think_and_a_call_are_told_apart_by_the_elbow(plans):
    apart = measure_appearance(ROBOT, stroke(plans["think"], 60)) - measure_appearance(
        ROBOT, stroke(plans["phone_call"], 60)
    )
    distances = np.sqrt((apart**2).sum(axis=-1).mean(axis=0))
    assert distances[4] > 0.07, "the right elbow"
    assert distances.max() > 0.08


def test_the_hand_that_performs_is_the_one_that_is_measured(known):
    form = known.lexicon.forms_by_id["phone_call"]
    right, left = (measure_place(form, plan_gesture(form, known, mode)) for mode in ("right", "left"))
    assert left == pytest.approx(right, abs=0.005)


def test_gestures_at_the_head_do_not_look_alike(plans):
    seen = {
        name: measure_appearance(ROBOT, stroke(planned, 60))
        for name, planned in plans.items()
        if not PLACES[name].at.startswith("other")
    }
    assert nearest_pairs(seen, TOO_NEAR) == []


@pytest.mark.parametrize("name", ["applause", "prayer", "cry", "despair", "photo", "gasp", "pride", "akimbo"])
def test_two_hands_that_do_the_same_are_mirror_images(plans, name):
    angles = stroke(plans[name])[0]
    left, right = (angles[list(ROBOT.arm(side).joints)] for side in "lr")
    assert degrees(np.abs(left - right).max()) < 3


def test_places_of_the_face_follow_the_head():
    asked = PlaceTable("tips", "mouth", 0.1)
    rest, turned = ROBOT.skeleton.rest, ROBOT.skeleton.rest.copy()
    turned[ROBOT.skeleton.names.index("skullbase_torsion")] = -0.5
    right, left = (place_distance(ROBOT, turned, side, asked) for side in "rl")
    assert right < place_distance(ROBOT, rest, "r", asked) < left


def moved(place, hinge):
    """[m] that a left palm at rest is farther from a place when one hinge turns."""
    asked, angles = PlaceTable("palm", place, 0.1), ROBOT.skeleton.rest.copy()
    still = place_distance(ROBOT, angles, "l", asked)
    angles[ROBOT.skeleton.names.index(hinge)] += 0.5
    return place_distance(ROBOT, angles, "l", asked) - still


def test_places_follow_their_part_of_the_body():
    assert moved("chest", "vl5_tilt") == pytest.approx(moved("belly", "vl5_tilt"), abs=1e-9)
    assert moved("chest", "vl5_tilt") == pytest.approx(0.0, abs=1e-9)
    assert abs(moved("hip", "vl5_tilt")) > 0.01
    assert abs(moved("other wrist", "r_shoulder_flexion")) > 0.01
    assert moved("other wrist", "r_wrist_flexion") == pytest.approx(0.0, abs=1e-9)
    assert abs(moved("other palm", "r_wrist_flexion")) > 0.003
    assert moved("other forearm", "r_elbow_twisting") == pytest.approx(0.0, abs=1e-9)
    assert moved("other shoulder", "r_elbow_flexion") == pytest.approx(0.0, abs=1e-9)


def test_sides_of_the_head_and_hips_are_those_of_the_hand():
    for place in ("ear", "eye", "hip"):
        asked = PlaceTable("palm", place, 0.1)
        left, right = (place_distance(ROBOT, ROBOT.skeleton.rest, side, asked) for side in "lr")
        assert left == pytest.approx(right), place
