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
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.realise import keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style
from kinesic.planning.collision import HOVER
from kinesic.planning.postures import postures
from kinesic.sim.distances import CapsuleDistances

from ..performances import LIMITS, ROBOT

PACE = Pace(ROBOT, LIMITS)
DISTANCES = CapsuleDistances(ROBOT)
LEXICON = Lexicon.load()


def solved(*actions, start: float = 1.0):
    times = dict(zip(GESTURE_SYNCS, start + np.array([0.0, 0.7, 0.7, 1.0, 1.2, 1.6, 2.4]), strict=True))
    timed = tuple(
        TimedBehaviour(Behaviour(f"b{k}", "x", action, Place(1, 1)), times) for k, action in enumerate(actions)
    )
    timeline = Timeline(Block("b", tuple(one.behaviour for one in timed)), timed)
    context = BlockContext(timeline.block, Context(Style(), LEXICON, PACE))
    return postures(keyframes(timeline, context), ROBOT, DISTANCES)


def at_sync(found, sync: str):
    return next(posture for posture in found.postures if any(name == sync for _, name in posture.syncs))


def test_begins_at_the_blocks_start_and_ends_at_rest():
    keys = solved(Gesture("offer", "both")).postures
    assert keys[0].time == 0.0
    for key in (keys[0], keys[-1]):
        np.testing.assert_allclose(key.angles, ROBOT.skeleton.rest)
        assert all(key.keyed)


def test_only_the_hand_that_gestures_is_keyed():
    stroke = at_sync(solved(Gesture("beat", "left")), "stroke")
    keyed = {name for name, key in zip(ROBOT.skeleton.names, stroke.keyed, strict=True) if key}
    assert {"l_elbow_flexion", "l_wrist_pivot"} <= keyed
    assert not any(name.startswith("r_") for name in keyed)


@pytest.mark.parametrize("lexeme", ["belly", "arms_crossed", "hands_together", "chin", "rub_hands"])
def test_touches_hover(lexeme):
    for posture in solved(Gesture(lexeme)).postures:
        if all(posture.keyed):
            continue
        assert DISTANCES.clearance(posture.angles[None]).distances[0] >= HOVER - 1e-6


def line_of_arm(angles, side: str = "l"):
    frames = ROBOT.skeleton.frames(angles)
    shoulder, _, wrist = (ROBOT.skeleton.segment(name) for name in ROBOT.chains[f"{side}_arm"][-3:])
    return frames.origins[shoulder], frames.origins[wrist] - frames.origins[shoulder]


@pytest.mark.parametrize("leaning", [False, True])
def test_pointing_meets_its_target_even_from_a_leaning_torso(leaning):
    lean = (Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),)),) if leaning else ()
    found = solved(Pointing("left", "left"), *lean)
    shoulder, arm = line_of_arm(at_sync(found, "stroke").angles)
    wanted = ROBOT.targets["left"] - shoulder
    cosine = arm @ wanted / np.linalg.norm(arm) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(min(1.0, cosine))) < 1.0
    assert np.linalg.norm(arm) > 0.95 * ROBOT.arm_length


def test_the_head_stays_level_while_the_torso_leans():
    found = solved(Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),)))
    angles = max((posture.angles for posture in found.postures), key=lambda a: a[ROBOT.skeleton.joint("vl5_tilt")])
    assert angles[ROBOT.skeleton.joint("vl5_tilt")] > 0.1
    head = ROBOT.skeleton.frames(angles).rotations[ROBOT.skeleton.segment("skullbase")]
    np.testing.assert_allclose(head[:, 0], [1, 0, 0], atol=1e-6)


def test_left_and_right_are_mirror_images():
    left, right = solved(Gesture("greet_wave", "left")), solved(Gesture("greet_wave", "right"))
    indices = [list(ROBOT.joints(chain)) for chain in ("l_arm", "r_arm")]
    for one, other in zip(left.postures, right.postures, strict=True):
        np.testing.assert_allclose(one.angles[indices[0]], other.angles[indices[1]], atol=1e-9)


def test_what_is_out_of_reach_is_said():
    found = solved(Gesture("offer", "both"))
    assert max(found.misses.values()) < 1e-6
