"""Tests of `hold_reach`: hand position, pointing and palm direction."""

import mujoco
import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.ik.pose import hold_reach, solve_pose
from kinesic.sim.model import build_model

DEFAULT_ROBOT = Robot.load()
ARM_CHAINS = DEFAULT_ROBOT.arms  # chains of both arms, by side
LEFT_ARM = ARM_CHAINS["l"]  # chain of the left arm


def _pose(chain: Chain, angles: Floats) -> tuple[Floats, Floats]:
    rotations, centres = chain.frames(angles)
    return centres[-2], rotations[-1]


@pytest.mark.parametrize("side", ["l", "r"])
def test_ik_meets_hand_position_pointing_and_palm_as_computed_by_mujoco(side: Side):
    """Compute targets and results by MuJoCo, independently of the solver."""
    model, chain = build_model(DEFAULT_ROBOT), ARM_CHAINS[side]
    data, random, held = mujoco.MjData(model), default_rng(41), []
    base, hand = model.body(chain.base).id, model.body(chain.joints[-1].name).id
    along = chain.joints[-1].bone / np.linalg.norm(chain.joints[-1].bone)

    def pose(angles: Floats) -> tuple[Floats, Floats, Floats]:
        data.qpos[:] = DEFAULT_ROBOT.skeleton.rest
        data.qpos[list(chain.indices)] = angles
        mujoco.mj_kinematics(model, data)
        turn = data.xmat[base].reshape(3, 3).T
        turned = turn @ data.xmat[hand].reshape(3, 3)
        return turn @ (data.xpos[hand] - data.xpos[base]), turned @ along, turned @ chain.palm

    for _ in range(1000):
        place, pointing, palm = pose(random.uniform(chain.lower, chain.upper))
        solution = hold_reach(chain, Reach(place, pointing, palm), start=chain.rest)
        assert np.all((chain.lower <= solution.angles) & (solution.angles <= chain.upper))
        at, ahead, aside = pose(solution.angles)
        off = max(np.linalg.norm(ahead - pointing), np.linalg.norm(aside - palm))
        held.append(np.linalg.norm(at - place) < 1e-4 and off < 1e-3)
    assert np.mean(held) >= 0.999


@pytest.mark.parametrize("side", ["l", "r"])
def test_hand_pose_given_by_directions_or_rotation_has_the_same_ik_solution(side: Side):
    chain, random = ARM_CHAINS[side], default_rng(44)
    along = chain.joints[-1].bone / np.linalg.norm(chain.joints[-1].bone)
    for _ in range(5):
        position, rotation = _pose(chain, random.uniform(chain.lower, chain.upper))
        reach = Reach(position, 3.0 * rotation @ along, 0.2 * rotation @ chain.palm)
        held = hold_reach(chain, reach, start=chain.rest)
        posed = solve_pose(chain, position, rotation, start=chain.rest)
        assert held.angles == pytest.approx(posed.angles, abs=1e-9)


def test_palm_direction_is_projected_perpendicular_to_the_pointing_direction():
    position, rotation = _pose(LEFT_ARM, LEFT_ARM.rest)
    along = LEFT_ARM.joints[-1].bone / np.linalg.norm(LEFT_ARM.joints[-1].bone)
    skewed = Reach(position, rotation @ along, rotation @ (LEFT_ARM.palm + 0.5 * along))
    solution = hold_reach(LEFT_ARM, skewed, start=LEFT_ARM.rest)
    assert solution.reached
    assert solution.angles == pytest.approx(LEFT_ARM.rest, abs=1e-6)


def test_invalid_hand_direction_or_position_raises_a_clear_error():
    place, ahead = LEFT_ARM.hand(LEFT_ARM.rest), np.array([1.0, 0.0, 0.0])
    with pytest.raises(ValueError, match=r"reach\.palm is None.*best_swivel"):
        hold_reach(LEFT_ARM, Reach(place, ahead), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"null or parallel; .* such as"):
        hold_reach(LEFT_ARM, Reach(place, ahead, -ahead), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"reach\.pointing .*finite"):
        hold_reach(LEFT_ARM, Reach(place, np.full(3, np.nan), ahead), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"position .*finite"):
        hold_reach(LEFT_ARM, Reach(np.full(3, np.nan), ahead, LEFT_ARM.palm), start=LEFT_ARM.rest)
