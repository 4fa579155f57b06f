"""Tests of arm postures at successive keys, solved together or singly."""

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.keys import ArmMode, Key, ReachLimits, pose_keys
from kinesic.ik.solve import solve

from ..reference.ik import keys as reference

ARM_CHAINS = Robot.load().arms  # chains of both arms, by side
LEFT_ARM = ARM_CHAINS["l"]  # chain of the left arm
# limits of elbow swivel and hinge rotation between keys
REACH_LIMITS = ReachLimits(max_swivel_change=0.4, max_hinge_step=1.9, open_swivel=1.36)


def _keys(chain: Chain, count: int, seed: int) -> list[Key]:
    """Return random keys of every mode, some of them out of reach."""
    random, keys = default_rng(seed), []
    for k in range(count):
        angles = random.uniform(0.7 * chain.lower, 0.7 * chain.upper)
        rotations, centres = chain.frames(angles)
        reach = Reach(
            np.array(centres[-2]) * (1.5 if k % 9 == 8 else 1.0),
            random.normal(size=3) if k % 3 else None,
            rotations[-1] @ chain.palm if k % 4 else None,
            0.3 if k % 11 == 10 else None,
        )
        mode = ArmMode.REST if k % 7 == 6 else ArmMode.STILL if k % 5 == 4 else ArmMode.REACH
        keys.append(Key(mode, chain.rest, reach, random.choice([0.0, 0.6]), passing=bool(k % 6 in (2, 3))))
    return keys


@pytest.mark.parametrize("chain", ARM_CHAINS.values(), ids=ARM_CHAINS)
@pytest.mark.parametrize("on_path", [True, False])
def test_arm_keys_solved_in_one_kernel_call_equal_the_python_reference(chain: Chain, on_path: bool):
    keys, path_start = _keys(chain, 9, seed=3), chain.rest + 0.05 if on_path else None
    one, two = (
        pose(chain, keys, REACH_LIMITS, start=chain.rest, path_start=path_start)
        for pose in (reference.pose_keys, pose_keys)
    )
    assert np.array_equal(one.angles[:8], two.angles[:8])  # before the first that is out of reach
    for name in ("angles", "beginnings", "swivels"):
        assert getattr(one, name) == pytest.approx(getattr(two, name), abs=1e-9, nan_ok=True)


def test_arm_keys_solved_one_by_one_match_those_solved_in_one_call():
    keys = _keys(LEFT_ARM, 7, seed=4)
    whole = pose_keys(LEFT_ARM, keys, REACH_LIMITS, start=LEFT_ARM.rest, path_start=None)
    start, path_start = LEFT_ARM.rest, None
    for k, key in enumerate(keys):
        part = pose_keys(LEFT_ARM, [key], REACH_LIMITS, start=start, path_start=path_start)
        assert np.array_equal(part.angles[0], whole.angles[k])
        start, path_start = part.angles[0], part.beginnings[0]


def test_arm_keeps_its_first_swivel_angle_along_a_hand_path():
    places = [np.array([0.28, 0.10 + 0.02 * k, -0.05]) for k in (0, 1, 2, 1, 0)]
    keys = [Key(ArmMode.REACH, LEFT_ARM.rest, Reach(place), passing=k > 0) for k, place in enumerate(places)]
    result = pose_keys(LEFT_ARM, keys, REACH_LIMITS, start=LEFT_ARM.rest, path_start=None)
    first = result.angles[0]
    assert np.array_equal(result.beginnings, np.tile(first, (5, 1)))
    for place, angles, turn in zip(places[1:], result.angles[1:], result.swivels[1:], strict=True):
        assert turn == swivel(LEFT_ARM, first)
        assert np.array_equal(angles, solve(LEFT_ARM, Reach(place, swivel=turn), start=first).angles)
    assert np.array_equal(result.angles[1], result.angles[3])


def test_arm_keys_that_reach_hold_open_the_elbow_or_return_to_rest_get_their_postures():
    reach = Reach(np.array([0.28, 0.10, -0.05]))
    keys = [
        Key(ArmMode.REACH, LEFT_ARM.rest, reach),
        Key(ArmMode.STILL, LEFT_ARM.rest),
        Key(ArmMode.REACH, LEFT_ARM.rest, reach, openness=1.0),
        Key(ArmMode.REST, LEFT_ARM.rest),
    ]
    angles = pose_keys(LEFT_ARM, keys, REACH_LIMITS, start=LEFT_ARM.rest, path_start=None).angles
    assert np.array_equal(angles[0], angles[1])
    assert swivel(LEFT_ARM, angles[2]) == pytest.approx(REACH_LIMITS.open_swivel, abs=1e-6)
    assert np.array_equal(angles[3], LEFT_ARM.rest)


def test_empty_arm_key_list_gives_no_postures():
    assert pose_keys(LEFT_ARM, [], REACH_LIMITS, start=LEFT_ARM.rest, path_start=None).angles.shape == (0, 8)


def test_nan_arm_key_target_raises_an_error():
    lost = Key(ArmMode.REACH, LEFT_ARM.rest, Reach(np.array([np.nan, 0.0, 0.0])))
    with pytest.raises(ValueError, match="finite"):
        pose_keys(LEFT_ARM, [lost], REACH_LIMITS, start=LEFT_ARM.rest, path_start=None)
