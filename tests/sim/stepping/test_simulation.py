import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors
from kinesic.sim.stepping.simulation import borrow_simulations, build_simulation

ROBOT = Robot.load()
SOFT, STIFF_AND_LIGHT = Factors(gain=0.3, friction=2.0), Factors(gain=1.5, armature=0.4, supply=0.9)
HEAVY = Factors(mass=1.2)


def borrow(*twins, touches=False):
    with borrow_simulations(ROBOT, twins, touches=touches) as lent:
        return lent


def saved(model):
    """All bytes that MuJoCo writes of a model."""
    whole = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, whole)
    return whole


def state(simulation):
    """All of it that the next step depends on."""
    whole = np.empty(mujoco.mj_stateSize(simulation.model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(simulation.model, simulation.data, whole, mujoco.mjtState.mjSTATE_INTEGRATION)
    return whole


@pytest.mark.parametrize("before", [NOMINAL, SOFT, STIFF_AND_LIGHT])
@pytest.mark.parametrize("after", [NOMINAL, SOFT, STIFF_AND_LIGHT])
def test_what_others_have_used_is_as_if_it_was_just_built(before, after):
    (used,) = borrow(before)
    used.data.qpos[:], used.data.qvel[:], used.data.ctrl[:] = 0.1, 0.5, 0.2
    mujoco.mj_step(used.model, used.data, 5)
    (again,) = borrow(after)
    fresh = build_simulation(ROBOT, after, touches=False)
    assert again is used
    np.testing.assert_array_equal(saved(again.model), saved(fresh.model))
    np.testing.assert_array_equal(state(again), state(fresh))


def test_twins_that_perform_together_have_each_its_own():
    with borrow_simulations(ROBOT, (NOMINAL, NOMINAL, SOFT), touches=False) as lent:
        inner = borrow(NOMINAL)
    assert len({id(each.data) for each in (*lent, *inner)}) == 4


@pytest.mark.parametrize("other", [{"touches": True}, {"twin": HEAVY}, {"twin": Factors(play=0.004)}])
def test_what_differs_in_more_than_drives_is_not_shared(other):
    (plain,) = borrow(NOMINAL)
    touches, twin = other.get("touches", False), other.get("twin", NOMINAL)
    (found,) = borrow(twin, touches=touches)
    assert found is not plain
    np.testing.assert_array_equal(saved(found.model), saved(build_simulation(ROBOT, twin, touches=touches).model))


def test_after_an_interruption_nothing_is_lent_again():
    with pytest.raises(KeyboardInterrupt), borrow_simulations(ROBOT, (PESSIMISTIC,), touches=False) as lent:
        raise KeyboardInterrupt
    assert borrow(PESSIMISTIC)[0] is not lent[0]
