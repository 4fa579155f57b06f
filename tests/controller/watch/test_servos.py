"""Clearance watch of servo readings: one hinge, 1 m/rad from a wall."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.dynamics import Clearance
from kinesic.controller.watch.clearance import CREEP_PACE, MAX_CREEP_TIME
from kinesic.controller.watch.servos import (
    MAX_READING_AGE,
    POSTURE_MEMORY,
    TRIM_COUNT,
    ServoWatch,
    WrittenPostures,
)
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.metrics.clearance_forecast import LOOK_PERIOD

MIN_CLEARANCE = 0.01  # [m] smallest clearance that the robot requires
COMMAND_PERIOD = 0.01
START_CLOCK = 100.0  # [s] clock at the start of the performance


class Wall:
    """Distance of one metre per radian from a wall at 0."""

    def clearance(self, angles):
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return angles


def standing(times):
    """Return a reference that stays 20 mm from the wall."""
    return np.full((len(times), 1), 0.02)


def nearing(times):
    """Return a reference that leaves the wall at 0.1 m/s."""
    return 0.02 + 0.1 * times[:, None]


def watch(reference=standing):
    return ServoWatch(reference, Wall(), min_clearance=MIN_CLEARANCE)


def status(time, angle, *, taken=None, clock=None, stage=Stage.ACTIVE):
    clock = START_CLOCK + time if clock is None else clock
    rows = [np.array([value]) for value in (angle, np.nan, clock if taken is None else taken)]
    return Status(stage, clock, time, 1.0, angles=rows[0], setpoints=rows[1], taken=rows[2])


def cycles(seconds, angle, *, begin=0.0, **changes):
    return [status(begin + k * COMMAND_PERIOD, angle, **changes) for k in range(round(seconds / COMMAND_PERIOD))]


def test_servo_watch_keeps_full_speed_for_servos_that_follow_the_plan_accurately():
    seen = watch()
    assert seen.ingest(cycles(0.5, 0.02))
    assert (seen.pace, seen.over) == (1.0, False)


def test_servo_watch_updates_its_time_scale_once_per_clearance_check_period():
    seen = watch()
    looks = [seen.ingest([cycle]) for cycle in cycles(1.0, 0.02)]
    assert sum(looks) == pytest.approx(1.0 / LOOK_PERIOD, abs=1)


def test_servo_watch_slows_time_at_tracking_errors_and_stops_at_too_small_measured_clearance():
    mild, grave = watch(), watch()
    mild.ingest(cycles(0.2, 0.0335))
    assert CREEP_PACE <= mild.pace < 1.0
    assert not mild.over
    grave.ingest(cycles(0.2, 0.002))
    assert grave.over


def test_servo_watch_requests_a_stop_after_the_maximum_time_at_minimum_speed():
    seen = watch()
    seen.ingest(cycles(MAX_CREEP_TIME - 0.2, 0.0035))
    assert seen.pace == CREEP_PACE
    assert not seen.over
    seen.ingest(cycles(0.3, 0.0035, begin=MAX_CREEP_TIME - 0.2))
    assert seen.over


def test_servo_watch_compares_a_late_position_reading_with_the_plan_at_its_reading_time():
    """The reading arrives two cycles late, when the plan has moved 2 mm."""
    seen = watch(nearing)
    for k in range(50):
        time = k * COMMAND_PERIOD
        taken = max(0.0, time - 0.02)
        seen.ingest([status(time, 0.02 + 0.1 * taken, taken=START_CLOCK + taken)])
    assert np.abs(seen.watch.recent_errors[-1]) < 1e-9


def test_servo_watch_ignores_missing_position_readings():
    seen = watch()
    seen.ingest(cycles(0.3, np.nan, taken=np.nan))
    assert seen.pace == 1.0
    assert seen.watch.recent_errors[-1] == 0.0


def test_servo_watch_ignores_outdated_position_readings():
    """A repeated reading must not look like a growing tracking error."""
    seen = watch(lambda times: 0.05 - 0.1 * times[:, None])
    seen.ingest([status(0.0, 0.05)])
    late = [status(k * COMMAND_PERIOD, 0.05, taken=START_CLOCK) for k in range(1, 31)]
    seen.ingest(late)
    assert late[-1].clock - START_CLOCK > MAX_READING_AGE
    assert seen.watch.recent_errors[-1] == 0.0


def test_servo_watch_is_reset_when_the_servos_are_stopped():
    seen = watch()
    seen.ingest(cycles(0.2, 0.002))
    assert seen.over
    assert seen.ingest([status(0.2, 0.0, stage=Stage.STOPPED)])
    assert (seen.pace, seen.over) == (1.0, False)
    assert not seen.ingest([status(0.2, 0.0, stage=Stage.STOPPED)])


def test_servo_watch_ignores_statuses_before_the_performance_starts():
    seen = watch()
    assert not seen.ingest([replace(status(0.0, 0.0), time=np.nan), status(0.0, 0.0, stage=Stage.APPROACH)])


def command(time, angle):
    rows = np.array([angle])
    return Command(time, rows, rows, rows, rows)


def test_servo_watch_interpolates_sent_postures_from_the_latest_commands():
    written = WrittenPostures()
    for k in range(10):
        written.add(command(k * COMMAND_PERIOD, float(k)))
    assert written(np.array([-1.0, 0.025, 0.09, 7.0])).ravel().tolist() == pytest.approx([0.0, 2.5, 9.0, 9.0])
    written.add(command(0.05, 50.0))  # the motion has changed: what was to come is void
    assert written(np.array([0.04, 0.05, 0.09])).ravel().tolist() == pytest.approx([4.0, 50.0, 50.0])


def test_servo_watch_deletes_old_sent_postures_from_memory():
    written, counts = WrittenPostures(), list[int]()
    for k in range(3000):
        written.add(command(k * COMMAND_PERIOD, float(k)))
        counts.append(len(written._times))
    assert written(np.array([29.9, 27.5])).ravel().tolist() == pytest.approx([2990.0, 2750.0])
    assert max(counts) <= round(POSTURE_MEMORY / COMMAND_PERIOD) + TRIM_COUNT + 2 < 405
