from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import (
    GESTURE_SYNCS,
    Behaviour,
    Block,
    Gesture,
    Place,
    Pointing,
    Posture,
    TimedBehaviour,
    Timeline,
)
from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.keyframes import Hand, KeyFrame, KeyFrames, Turn
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style
from kinesic.planning.collision import HOVER_DISTANCE
from kinesic.planning.postures import _is_exact, _tasks, solve_postures
from kinesic.sim.distances import CapsuleDistances

from ..performances import LIMITS, ROBOT

ROBOT_PACE = Pace(ROBOT, LIMITS)  # rest-to-rest durations of the robot's movements
CAPSULE_DISTANCES = CapsuleDistances(ROBOT)  # self-distances of the robot
BUILTIN_LEXICON = Lexicon.load()


def solved(*actions, start: float = 1.0):
    times = dict(zip(GESTURE_SYNCS, start + np.array([0.0, 0.7, 0.7, 1.0, 1.2, 1.6, 2.4]), strict=True))
    timed = tuple(
        TimedBehaviour(Behaviour(f"b{k}", "x", action, Place(1, 1)), times) for k, action in enumerate(actions)
    )
    timeline = Timeline(Block("b", tuple(one.behaviour for one in timed)), timed)
    context = BlockContext(timeline.block, Context(Style(), BUILTIN_LEXICON, ROBOT_PACE))
    return solve_postures(make_keyframes(timeline, context), ROBOT, CAPSULE_DISTANCES)


def at_sync(found, sync: str):
    return next(posture for posture in found.postures if any(name == sync for _, name in posture.syncs))


def test_key_postures_begin_and_end_with_the_rest_posture():
    keys = solved(Gesture("offer", "both")).postures
    assert keys[0].time == 0.0
    for key in (keys[0], keys[-1]):
        np.testing.assert_allclose(key.angles, ROBOT.skeleton.rest)
        assert all(key.keyed)


def test_stroke_posture_of_a_left_handed_gesture_has_keys_for_no_joint_of_the_right_arm():
    stroke = at_sync(solved(Gesture("beat", "left")), "stroke")
    keyed = {name for name, key in zip(ROBOT.skeleton.names, stroke.keyed, strict=True) if key}
    assert {"l_elbow_flexion", "l_wrist_pivot"} <= keyed
    assert not any(name.startswith("r_") for name in keyed)


@pytest.mark.parametrize("lexeme", ["belly", "arms_crossed", "hands_together", "chin", "rub_hands"])
def test_hand_in_a_touching_posture_keeps_the_hover_distance(lexeme):
    for posture in solved(Gesture(lexeme)).postures:
        if all(posture.keyed):
            continue
        assert CAPSULE_DISTANCES.clearance(posture.angles[None]).distances[0] >= HOVER_DISTANCE - 1e-6


def line_of_arm(angles, side: str = "l"):
    frames = ROBOT.skeleton.frames(angles)
    shoulder, _, wrist = (ROBOT.skeleton.segment(name) for name in ROBOT.chains[f"{side}_arm"][-3:])
    return frames.origins[shoulder], frames.origins[wrist] - frames.origins[shoulder]


@pytest.mark.parametrize("leaning", [False, True])
def test_pointing_meets_its_target_even_from_a_leaning_torso(leaning):
    lean = (Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),)),) if leaning else ()
    result = solved(Pointing("left", "left"), *lean)
    shoulder, arm = line_of_arm(at_sync(result, "stroke").angles)
    wanted = ROBOT.targets["left"] - shoulder
    cosine = arm @ wanted / np.linalg.norm(arm) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(min(1.0, cosine))) < 1.0
    assert np.linalg.norm(arm) > 0.95 * ROBOT.arm_length


def test_head_stays_level_while_the_torso_leans():
    result = solved(Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),)))
    angles = max((posture.angles for posture in result.postures), key=lambda a: a[ROBOT.skeleton.joint("vl5_tilt")])
    assert angles[ROBOT.skeleton.joint("vl5_tilt")] > 0.1
    head = ROBOT.skeleton.frames(angles).rotations[ROBOT.skeleton.segment("skullbase")]
    np.testing.assert_allclose(head[:, 0], [1, 0, 0], atol=1e-6)


def test_gesture_postures_of_left_and_right_are_mirror_images():
    left, right = solved(Gesture("greet_wave", "left")), solved(Gesture("greet_wave", "right"))
    indices = [list(ROBOT.joints(chain)) for chain in ("l_arm", "r_arm")]
    for one, other in zip(left.postures, right.postures, strict=True):
        np.testing.assert_allclose(one.angles[indices[0]], other.angles[indices[1]], atol=1e-9)


def test_reachable_hand_targets_have_no_position_error():
    result = solved(Gesture("offer", "both"))
    assert max(result.misses.values()) < 1e-6


def frames_of_left_hand(*places, uses=frozenset({"l_hand"})) -> KeyFrames:
    """Return key frames of the left hand, one per second.

    Positions are in [m], or None for rest.
    """
    timeline = Timeline(Block("b", ()), ())
    frames = [
        KeyFrame(
            float(k),
            Turn(),
            Turn(),
            {"l": Hand() if place is None else Hand(Reach(sealed(place))), "r": Hand()},
            frozenset({"l_hand"}),
            (("b0", "stroke"),) if place is not None else (),
        )
        for k, place in enumerate(places)
    ]
    return KeyFrames(timeline, tuple(frames), {}, {"b0": uses})


def test_torso_leans_only_at_the_key_with_a_far_hand_target():
    near, far = (0.3, 0.2, 0.8), (0.55, 0.2, 0.8)
    postures = solve_postures(
        frames_of_left_hand(None, near, near, far, near, near, None), ROBOT, CAPSULE_DISTANCES
    ).postures
    torso = list(ROBOT.joints("torso"))
    assert [bool(np.any(posture.angles[torso])) for posture in postures] == [
        False,
        False,
        False,
        True,
        False,
        False,
        False,
    ]
    assert [posture.keyed[torso[0]] for posture in postures] == [True, False, True, True, True, False, True]


def test_torso_has_keys_at_a_lean_about_one_axis_and_at_the_frames_before_and_after_it():
    frames = frames_of_left_hand(None, *[(0.3, 0.2, 0.8)] * 5, None)
    leans = [np.array([0.0, 0.1 if k == 3 else 0.0, 0.0]) for k in range(7)]
    tasks = _tasks(frames, leans, np.tile(ROBOT.skeleton.rest, (7, 1)), ROBOT)
    torso = ROBOT.joints("torso")[0]
    assert [task.keyed[torso] for task in tasks] == [True, False, True, True, True, False, True]


@pytest.mark.parametrize(
    ("given", "syncs", "is_firm"),
    [
        (("l_hand",), (), False),
        (("l_hand", "head"), (), True),
        (("r_hand",), (), True),
        (("l_hand",), (("g", "stroke"),), True),
    ],
)
def test_motion_may_miss_only_keys_on_the_path_of_one_hand_without_sync_points(given, syncs, is_firm):
    frame = frames_of_left_hand(None, (0.3, 0.2, 0.8), None).frames[1]
    hands = {**frame.hands, "l": replace(frame.hands["l"], passing=True)}
    assert _is_exact(replace(frame, hands=hands, given=frozenset(given), syncs=syncs)) is is_firm


def test_distance_to_an_unreachable_target_is_assigned_to_the_behaviour():
    away = (3.0, 0.2, 0.8)
    postures = solve_postures(frames_of_left_hand(None, (0.3, 0.2, 0.8), away, None), ROBOT, CAPSULE_DISTANCES)
    at = next(posture for posture in postures.postures if posture.time == 2.0)
    wrist = ROBOT.skeleton.frames(at.angles).origins[ROBOT.arm("l").wrist]
    assert postures.misses == {"b0": pytest.approx(np.linalg.norm(wrist - away))}
    assert postures.misses["b0"] > 1.0
    assert (
        solve_postures(
            frames_of_left_hand(None, away, None, uses=frozenset({"r_hand"})), ROBOT, CAPSULE_DISTANCES
        ).misses
        == {}
    )


@pytest.mark.parametrize(("start", "begins"), [(0.0, False), (0.001, False), (0.5, True)])
def test_rest_posture_at_time_zero_precedes_the_keys_only_if_the_gesture_starts_later(start, begins):
    postures = solved(Gesture("offer", "left"), start=start).postures
    times = [posture.time for posture in postures]
    assert times == sorted(set(times))
    assert bool(times[0] == 0.0 and times[1] == start) is begins


def left_arms(*reaches: Reach) -> list[np.ndarray]:
    """Return the left arm's angles [rad] at successive keys with given reaches."""
    hands = [Hand(), *(Hand(reach) for reach in reaches), Hand()]
    frames = tuple(
        KeyFrame(float(k), Turn(), Turn(), {"l": hand, "r": Hand()}, frozenset({"l_hand"}), ())
        for k, hand in enumerate(hands)
    )
    given = KeyFrames(Timeline(Block("b", ()), ()), frames, {}, {})
    postures = solve_postures(given, ROBOT, CAPSULE_DISTANCES).postures
    return [posture.angles[list(ROBOT.joints("l_arm"))] for posture in postures[1:-1]]


HAND_POSITION = sealed([0.3, 0.2, 0.8])  # (3,) [m]
CHANGED_TARGETS = {  # change of a hand target -> attributes of `Reach`
    "swivel": {"swivel": 0.5},
    "palm": {"palm": sealed([0.0, 0.0, 1.0])},
    "pointing": {"pointing": sealed([1.0, 0.0, 0.0])},
}


@pytest.mark.parametrize("field", CHANGED_TARGETS)
def test_arm_turns_at_the_same_hand_position_if_swivel_palm_or_pointing_changes(field: str):
    plain, turned, again = left_arms(
        Reach(HAND_POSITION),
        Reach(HAND_POSITION, **CHANGED_TARGETS[field]),
        Reach(HAND_POSITION, **CHANGED_TARGETS[field]),
    )
    assert np.abs(turned - plain).max() > 0.05
    np.testing.assert_array_equal(turned, again)


def test_arm_posture_follows_a_changed_hand_target():
    first, second = left_arms(Reach(HAND_POSITION), Reach(sealed([0.3, 0.25, 0.8])))
    assert np.abs(first - second).max() > 0.02
