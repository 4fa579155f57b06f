"""Tests of touches by a requested fingertip or palm."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import widen_key
from kinesic.planning import collision
from kinesic.planning.collision import GAP_TOLERANCE, HOVER_DISTANCE, TOUCH_TOLERANCE
from kinesic.planning.contact import SurfaceTouch, palm_balls, touched_pairs, touched_segment
from kinesic.session.setup import set_up
from kinesic.sim.worst_postures import random_postures
from kinesic.studies.gestures.isolated import plan_gesture


@pytest.fixture(scope="module")
def known():
    return set_up("upper36")


@pytest.mark.parametrize("name", ["hush", "own_mouth", "think", "phone_call", "steeple", "watch_time"])
def test_requested_fingertip_hovers_at_its_target_and_other_parts_keep_distance(known, name):
    form, robot = known.lexicon.forms_by_id[name], known.robot
    planned = plan_gesture(form, known)
    keyed = np.array([posture.angles for posture in planned.postures.postures])
    for key in form.keys:
        for side, pose in key.hands.items():
            if pose.tip is not None and pose.tip != "palm":
                touch = SurfaceTouch.of(side, Hand(touch=pose.touch, tip=pose.tip), robot)
                assert touch is not None
                gaps = touch.gaps(keyed)
                assert HOVER_DISTANCE - GAP_TOLERANCE <= gaps.min() <= HOVER_DISTANCE + TOUCH_TOLERANCE + GAP_TOLERANCE
                assert known.distances.gaps(keyed[gaps.argmin()][None]).min() >= HOVER_DISTANCE - GAP_TOLERANCE


def test_fingertip_contact_requires_fingers_and_a_touched_body_part(known):
    plain = set_up("upper22").robot
    assert SurfaceTouch.of("r", Hand(touch="head", tip="index"), plain) is None
    assert SurfaceTouch.of("r", Hand(tip="index"), known.robot) is None
    assert SurfaceTouch.of("r", Hand(touch="head"), known.robot) is None


@pytest.mark.parametrize(
    ("touch", "segment"),
    [
        ("hand", "r_wrist"),
        ("forearm", "r_elbow"),
        ("upper_arm", "r_shoulder"),
        ("head", "skullbase"),
        ("chest", "vl5"),
        ("lap", "humanoid_root"),
    ],
)
def test_left_hand_touches_parts_of_the_right_arm_and_of_the_body(known, touch, segment):
    assert touched_segment("l", touch, known.robot) == segment


def test_lexicon_gesture_with_a_fingertip_but_no_touched_part_is_refused(tmp_path):
    file = tmp_path / "mine.toml"
    hand = '{ right = { at = [0.3, 0.2, 0.5], tip = "index" } }'
    file.write_text(f'category = "emblem"\n[[gesture]]\nid = "poke"\nkeys = [{hand}]\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="gesture poke: tip is 'index' and touch is missing"):
        Lexicon.load(file)


@pytest.mark.parametrize("touch", ["chest", "head", "forearm", "upper_arm", "hand"])
def test_fingertip_gap_is_the_distance_to_the_nearest_capsule_of_the_touched_part(known, touch):
    robot = known.robot
    postures = random_postures(robot.skeleton, 12, seed=3)
    result = SurfaceTouch.of("l", Hand(touch=touch, tip="index"), robot)
    frames, ((tip, other_part),) = robot.skeleton.frames(postures), result.meetings
    place = frames.origins[:, tip.segment] + frames.rotations[:, tip.segment] @ tip.place
    if touch == "hand":
        other = robot.finger_tips("r")["index"]
        points, radii = (
            [frames.origins[:, other.segment] + frames.rotations[:, other.segment] @ other.place],
            [other.radius],
        )
    else:
        segment, along = robot.skeleton.segments[other_part], np.linspace(0.0, 1.0, 400)
        pairs = [(capsule, share) for capsule in segment.capsules for share in along]
        points = [
            frames.origins[:, other_part]
            + frames.rotations[:, other_part] @ (capsule.start + share * (capsule.end - capsule.start))
            for capsule, share in pairs
        ]
        radii = [capsule.radius for capsule, _ in pairs]
    apart = [np.linalg.norm(place - point, axis=1) - radius for point, radius in zip(points, radii, strict=True)]
    np.testing.assert_allclose(result.gaps(postures)[0], np.min(apart, axis=0) - tip.radius, atol=2e-4)


def test_fingertip_has_no_target_if_the_robot_lacks_the_body_part(known):
    robot = replace(known.robot, chains={name: each for name, each in known.robot.chains.items() if name != "neck"})
    assert SurfaceTouch.of("r", Hand(touch="head", tip="index"), robot) is None
    assert SurfaceTouch.of("r", Hand(touch="chest", tip="index"), robot) is not None


@pytest.mark.parametrize("touch", ["head", "hand", "chest"])
def test_touch_by_fingertip_then_by_hand_then_without_contact_is_tried(known, monkeypatch, touch):
    robot, rest = known.robot, known.robot.skeleton.rest
    tried = []
    monkeypatch.setattr(collision, "separate", lambda *given: tried.append(given[-1]))
    near = np.full(len(robot.counted_pairs), HOVER_DISTANCE / 2)
    hand = Hand(resting_hands(robot)["r"], touch=touch, tip="index")
    np.testing.assert_array_equal(collision.clear_hands(rest, {"r": hand}, robot, known.distances, near), rest)
    pair = collision.touched_pair("r", touch, robot, near)
    assert [(spacing.min_distance, spacing.touching, len(spacing.surfaces)) for spacing in tried] == [
        (HOVER_DISTANCE, (), 1),
        (HOVER_DISTANCE, (pair,), 0),
        (HOVER_DISTANCE, (), 0),
    ]


@pytest.mark.parametrize("name", ["human", "upper36", "upper22"])
def test_palm_spheres_reach_the_surface_of_the_hand_in_the_palm_direction(name):
    robot = Robot.load(name)
    for side in SIDES:
        arm = robot.arm(side)
        for ball in palm_balls(robot, side):
            surface = ball.place + ball.radius * arm.palm.facing
            distances = []
            for capsule in robot.skeleton.segments[arm.wrist].capsules:
                along = capsule.end - capsule.start
                fraction = np.clip((surface - capsule.start) @ along / (along @ along), 0.0, 1.0)
                distances.append(np.linalg.norm(surface - capsule.start - fraction * along) - capsule.radius)
            assert abs(min(distances)) < 1e-3  # [m]


def test_touched_chest_includes_segments_without_a_hinge():
    robot = Robot.load("human")
    touched = {name for k in touched_pairs("r", "chest", robot) for name in robot.counted_pairs[k]}
    assert touched == {"vl5", "vt1", "r_wrist", "r_fingers"}


def test_scaling_a_prayer_gesture_does_not_spread_its_touching_hands(known):
    form = known.lexicon.forms_by_id["prayer"]
    apart = [abs(pose.position[1]) for pose in widen_key(form.keys[-1], 0.0, known.robot).hands.values()]
    assert max(apart) <= 0.07  # [arm lengths]
