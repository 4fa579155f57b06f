import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors
from kinesic.sim.stepping.simulation import borrow_simulations, build_simulation

ROBOT = Robot.load()
SOFT_DRIVES = Factors(gain=0.3, friction=2.0)
STIFF_DRIVES = Factors(gain=1.5, armature=0.4, supply=0.9)
HEAVY_LINKS = Factors(mass=1.2)


def borrow(*twins, touches=False):
    with borrow_simulations(ROBOT, twins, touches=touches) as lent:
        return lent


def model_bytes(model):
    """Return all bytes that MuJoCo writes for a model."""
    whole = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, whole)
    return whole


def full_state(simulation):
    """Return all of MuJoCo's state that affects the next step."""
    whole = np.empty(mujoco.mj_stateSize(simulation.model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(simulation.model, simulation.data, whole, mujoco.mjtState.mjSTATE_INTEGRATION)
    return whole


@pytest.mark.parametrize("before", [NOMINAL_FACTORS, SOFT_DRIVES, STIFF_DRIVES])
@pytest.mark.parametrize("after", [NOMINAL_FACTORS, SOFT_DRIVES, STIFF_DRIVES])
def test_reused_simulation_equals_a_new_one(before, after):
    (used,) = borrow(before)
    used.data.qpos[:], used.data.qvel[:], used.data.ctrl[:] = 0.1, 0.5, 0.2
    mujoco.mj_step(used.model, used.data, 5)
    (again,) = borrow(after)
    fresh = build_simulation(ROBOT, after, touches=False)
    assert again is used
    np.testing.assert_array_equal(model_bytes(again.model), model_bytes(fresh.model))
    np.testing.assert_array_equal(full_state(again), full_state(fresh))


def test_concurrent_twins_get_separate_simulations():
    with borrow_simulations(ROBOT, (NOMINAL_FACTORS, NOMINAL_FACTORS, SOFT_DRIVES), touches=False) as lent:
        inner = borrow(NOMINAL_FACTORS)
    assert len({id(item.data) for item in (*lent, *inner)}) == 4


@pytest.mark.parametrize("other", [{"touches": True}, {"twin": HEAVY_LINKS}, {"twin": Factors(play=0.004)}])
def test_simulation_is_not_reused_with_other_contacts_masses_or_backlash(other):
    (plain,) = borrow(NOMINAL_FACTORS)
    touches, twin = other.get("touches", False), other.get("twin", NOMINAL_FACTORS)
    (result,) = borrow(twin, touches=touches)
    assert result is not plain
    np.testing.assert_array_equal(
        model_bytes(result.model), model_bytes(build_simulation(ROBOT, twin, touches=touches).model)
    )


def test_interrupted_simulations_are_not_reused():
    with pytest.raises(KeyboardInterrupt), borrow_simulations(ROBOT, (PESSIMISTIC_FACTORS,), touches=False) as lent:
        raise KeyboardInterrupt
    assert borrow(PESSIMISTIC_FACTORS)[0] is not lent[0]
