"""What a watch makes of positions that were read on a wire: one hinge, one metre per radian from a wall."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.dynamics import Clearance
from kinesic.controller.watch.clearance import CREEP, LONGEST_CREEP, LOOK
from kinesic.controller.watch.servos import FRESH, ServoWatch, WrittenPostures
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage

LEAST = 0.01  # [m]
PERIOD = 0.01
BEGAN = 100.0  # [s] of the clock, when the performance began


class Wall:
    """One metre per radian from a wall at 0."""

    def clearance(self, angles):
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return angles


def standing(times):
    """A plan that stands 20 mm from the wall."""
    return np.full((len(times), 1), 0.02)


def nearing(times):
    """One that moves away from it at 0.1 m/s."""
    return 0.02 + 0.1 * times[:, None]


def watch(reference=standing):
    return ServoWatch(reference, Wall(), least=LEAST)


def status(time, angle, *, taken=None, clock=None, stage=Stage.ACTIVE):
    clock = BEGAN + time if clock is None else clock
    rows = [np.array([value]) for value in (angle, np.nan, clock if taken is None else taken)]
    return Status(stage, clock, time, 1.0, angles=rows[0], goals=rows[1], taken=rows[2])


def cycles(seconds, angle, *, begin=0.0, **changes):
    return [status(begin + k * PERIOD, angle, **changes) for k in range(round(seconds / PERIOD))]


def test_servos_where_they_should_be_leave_time_alone():
    seen = watch()
    assert seen.see(cycles(0.5, 0.02))
    assert (seen.pace, seen.over) == (1.0, False)


def test_it_looks_every_fiftieth_of_a_second_and_says_so():
    seen = watch()
    looks = [seen.see([each]) for each in cycles(1.0, 0.02)]
    assert sum(looks) == pytest.approx(1.0 / LOOK, abs=1)


def test_errors_slow_time_down_and_too_large_ones_end_it_at_once():
    mild, grave = watch(), watch()
    mild.see(cycles(0.2, 0.0335))
    assert CREEP <= mild.pace < 1.0
    assert not mild.over
    grave.see(cycles(0.2, 0.002))
    assert grave.over


def test_who_waits_in_vain_is_over():
    seen = watch()
    seen.see(cycles(LONGEST_CREEP - 0.2, 0.0035))
    assert seen.pace == CREEP
    assert not seen.over
    seen.see(cycles(0.3, 0.0035, begin=LONGEST_CREEP - 0.2))
    assert seen.over


def test_an_angle_is_compared_with_the_plan_when_it_was_taken():
    """It comes two cycles late; compared with the present plan it would seem to stray by 2 mm, and less than that."""
    seen = watch(nearing)
    for k in range(50):
        time = k * PERIOD
        taken = max(0.0, time - 0.02)
        seen.see([status(time, 0.02 + 0.1 * taken, taken=BEGAN + taken)])
    assert np.abs(seen.watch.strayed[-1]) < 1e-9


def test_what_is_missing_is_not_weighed():
    seen = watch()
    seen.see(cycles(0.3, np.nan, taken=np.nan))
    assert seen.pace == 1.0
    assert seen.watch.strayed[-1] == 0.0


def test_what_is_old_is_not_weighed():
    """The same position, said again and again while the plan goes on, is no error that grows."""
    seen = watch(lambda times: 0.05 - 0.1 * times[:, None])
    seen.see([status(0.0, 0.05)])
    late = [status(k * PERIOD, 0.05, taken=BEGAN) for k in range(1, 31)]
    seen.see(late)
    assert late[-1].clock - BEGAN > FRESH
    assert seen.watch.strayed[-1] == 0.0


def test_servos_that_stood_still_begin_anew():
    seen = watch()
    seen.see(cycles(0.2, 0.002))
    assert seen.over
    assert seen.see([status(0.2, 0.0, stage=Stage.STOPPED)])
    assert (seen.pace, seen.over) == (1.0, False)
    assert not seen.see([status(0.2, 0.0, stage=Stage.STOPPED)])


def test_a_performance_that_has_not_begun_is_not_watched():
    seen = watch()
    assert not seen.see([replace(status(0.0, 0.0), time=np.nan), status(0.0, 0.0, stage=Stage.APPROACH)])


def command(time, angle):
    rows = np.array([angle])
    return Command(time, rows, rows, rows, rows)


def test_written_postures_are_those_of_the_last_commands():
    written = WrittenPostures()
    for k in range(10):
        written.add(command(k * PERIOD, float(k)))
    assert written(np.array([-1.0, 0.025, 0.09, 7.0])).ravel().tolist() == pytest.approx([0.0, 2.5, 9.0, 9.0])
    written.add(command(0.05, 50.0))  # the motion has changed: what was to come is void
    assert written(np.array([0.04, 0.05, 0.09])).ravel().tolist() == pytest.approx([4.0, 50.0, 50.0])


def test_written_postures_forget_what_is_long_past():
    written = WrittenPostures()
    for k in range(3000):
        written.add(command(k * PERIOD, float(k)))
    assert written(np.array([29.9, 27.5])).ravel().tolist() == pytest.approx([2990.0, 2750.0])
    assert len(written._times) < 500
