"""Answers that come after their cycle, and clocks that only make them seem to."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.bus.late_replies import STUCK
from kinesic.hardware.protocol.registers import Register

from ..conftest import Rig

MID = 2048
Make = Callable[..., Rig]


def miss_a_cycle(made: Rig) -> None:
    """From now on, answers are suspected to be late."""
    for servo in made.plant.servos:
        servo.mute = True
    made.run(1)
    for servo in made.plant.servos:
        servo.mute = False


def test_clocks_that_have_moved_apart_are_compared_anew(rig: Make):
    made = rig(7)
    made.run(10)
    made.plant.advance(made.wire.now() + 0.03)  # the servos' clocks run ahead, then stand until the wire's has come up
    miss_a_cycle(made)
    cycles = made.run(50)
    assert all(cycle.fresh.all() for cycle in cycles[8:])
    assert cycles[-1].duration < 0.5 * made.bus.period
    assert made.bus.cycle().ages.max() < made.bus.period


@pytest.mark.parametrize("apart", [0.008, 0.02, 0.1])
def test_records_that_seem_to_be_old_are_put_to_the_test(rig: Make, apart: float):
    made = rig(7)
    made.run(10)
    made.bus._believed.times = made.bus._believed.times - apart
    miss_a_cycle(made)
    cycles = made.run(20)
    assert not cycles[0].fresh.any()
    assert all(cycle.fresh.all() for cycle in cycles[4:])
    assert not any(cycle.events for cycle in cycles)


def test_goals_go_out_while_nothing_is_asked(rig: Make):
    made = rig(7)
    made.energise()
    made.bus._late._seeming = STUCK
    (cycle,) = made.run(1, np.full(7, MID + 9))
    assert not cycle.fresh.any()
    assert (made.true(Register.GOAL_POSITION) == MID + 9).all()
    assert made.run(1)[0].fresh.all()


def test_answers_that_are_late_indeed_stay_so(rig: Make):
    made = rig(7, latency=0.016)
    cycles = made.run(150, np.full(7, MID))[20:]
    assert not any(cycle.fresh.all() for cycle in cycles)
    apart = [cycle.each("tick") / 1000 - cycle.times for cycle in cycles]
    assert np.ptp(apart) < made.bus.period / 2
    assert max(cycle.ages.max() for cycle in cycles) < 0.03
