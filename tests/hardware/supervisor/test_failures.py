"""Reports of failing servos, and duration of interruptions."""

import pytest

from kinesic.hardware.protocol.registers import HardwareError
from kinesic.hardware.supervisor.failures import FailureWatch, InterruptionWatch
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.state_machine import Stage

from .judged import Room

MAX_INTERRUPTION = 0.5  # [s] longest interruption without a resume request


class Watched:
    """Watch of servo failures with its log."""

    def __init__(self, room: Room, manifest: Manifest) -> None:
        self.room, self.log = room, list[tuple[str, str]]()
        self.watch = FailureWatch(manifest, lambda kind, text: self.log.append((kind, text)))

    def look(self, cycles: int = 1) -> tuple[str, ...]:
        return self.watch.look(self.room.look(cycles))

    def err(self, place: int, error: HardwareError | None) -> tuple[str, ...]:
        self.room.records["hardware_error"][place] = 0 if error is None else error.value
        return self.look()


@pytest.fixture
def watched(room: Room, manifest: Manifest) -> Watched:
    made = Watched(room, manifest)
    assert made.look() == ()
    return made


def test_servo_failure_is_reported_once_with_its_hinge_names(watched: Watched):
    watched.room.records["hardware_error"][1] = HardwareError.OVERLOAD.value
    assert watched.err(3, HardwareError.OVERHEATING) == ("failed",)
    assert watched.log == [("failed", "torsion, l_twist: shut down or blocked")]
    assert watched.look() == ()
    assert len(watched.log) == 1


def test_hinge_whose_servos_fail_together_is_named_once(watched: Watched):
    watched.room.records["hardware_error"][0] = HardwareError.OVERLOAD.value
    assert watched.err(1, HardwareError.OVERLOAD) == ("failed",)
    assert watched.log == [("failed", "torsion: shut down or blocked")]


def test_servo_failures_at_the_start_are_reported(room: Room, manifest: Manifest):
    first = Watched(room, manifest)
    room.records["hardware_error"][1] = HardwareError.OVERLOAD.value
    assert first.err(0, HardwareError.VOLTAGE) == ("failed",)
    assert [kind for kind, _ in first.log] == ["failed", "supply"]


def test_later_failure_of_another_servo_is_reported(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    assert watched.err(4, HardwareError.OVERLOAD) == ("failed",)
    assert watched.log[1:] == [("failed", "r_flexion: shut down or blocked")]


def test_servo_failure_that_recurs_after_recovery_is_reported_again(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    assert watched.err(1, None) == ("mended",)
    assert watched.look() == ()
    assert watched.err(1, HardwareError.OVERLOAD) == ("failed",)
    assert len(watched.log) == 2


def test_servo_failure_and_recovery_in_one_cycle_are_both_reported(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    watched.room.records["hardware_error"][1] = 0
    assert watched.err(2, HardwareError.OVERLOAD) == ("failed", "mended")


def test_silent_servo_that_answers_again_is_reported_as_recovered(watched: Watched):
    watched.room.recent[2] = False
    assert watched.look() == ()
    watched.room.recent[2] = True
    assert watched.look() == ("mended",)
    assert watched.log == []


def test_servo_that_answers_with_an_error_is_not_reported_as_recovered(watched: Watched):
    watched.room.recent[2] = False
    watched.look()
    watched.room.recent[2] = True
    assert watched.err(2, HardwareError.OVERLOAD) == ("failed",)


def test_weak_supply_is_logged_once_with_lowest_voltage(watched: Watched):
    watched.room.records["volts"] = [95, 94, 93, 95, 95]
    assert watched.err(0, HardwareError.VOLTAGE) == ()
    assert watched.log == [("supply", "9.3 V are too low: the robot folds")]
    assert watched.err(1, HardwareError.VOLTAGE) == ()
    assert len(watched.log) == 1
    watched.room.records["hardware_error"] = 0
    watched.look()
    watched.err(1, HardwareError.VOLTAGE)
    assert len(watched.log) == 2


class Clock:
    """Watch of interruptions with its simulated time."""

    def __init__(self) -> None:
        self.time = 0.0
        self.watch = InterruptionWatch(MAX_INTERRUPTION)

    def cycle(self, seconds: float, *, well: bool = True) -> InterruptionWatch:
        """Run a performance cycle some time [s] after the last one."""
        return self.take(seconds, Stage.ACTIVE, before=True, well=well)

    def take(
        self, seconds: float, stage: Stage, *, before: bool, left: bool = True, fresh: bool = False, well: bool = True
    ) -> InterruptionWatch:
        self.time += seconds
        self.watch.note_commands(self.time, stage=stage, before=before, left=left, fresh=fresh)
        self.watch.note_servos(well=well)
        return self.watch


@pytest.fixture
def clock() -> Clock:
    made = Clock()
    assert not made.cycle(64.0).interrupted
    return made


def test_interruption_watch_reports_nothing_at_first_and_a_suspended_process_after_a_late_cycle():
    watch = InterruptionWatch(MAX_INTERRUPTION)
    assert (watch.interrupted, watch.fault_duration) == (False, 0.0)
    watch.note_commands(0.75, stage=Stage.HOLD, before=False, left=True, fresh=False)
    assert (watch.interrupted, watch.fault_duration) == (True, 0.75)
    assert watch.describe("") == "this process was suspended (0.8 s or more)"


def test_healthy_servos_cause_no_interruption(clock: Clock):
    assert not clock.cycle(0.25).interrupted
    assert clock.watch.fault_duration == 0.0


def test_long_servo_fault_counts_as_interruption(clock: Clock):
    assert not clock.cycle(0.25, well=False).interrupted
    assert not clock.cycle(0.25, well=False).interrupted
    assert clock.watch.fault_duration == MAX_INTERRUPTION
    assert clock.cycle(0.25, well=False).interrupted
    assert clock.watch.fault_duration == 0.75
    assert clock.watch.describe("l_twist: silent") == "l_twist: silent (0.8 s or more)"
    assert not clock.cycle(0.25).interrupted


def test_process_suspended_for_three_seconds_counts_as_interrupted(clock: Clock):
    clock.watch.note_commands(clock.time + 3.0, stage=Stage.ACTIVE, before=True, left=True, fresh=False)
    assert clock.watch.interrupted
    assert clock.watch.describe("") == "this process was suspended (3.0 s or more)"


def test_commands_after_a_long_gap_count_as_interruption(clock: Clock):
    for _ in range(3):
        assert not clock.take(0.25, Stage.HOLD, before=False, left=False).interrupted
    assert clock.take(0.25, Stage.HOLD, before=False).interrupted
    assert clock.watch.describe("l_twist: silent") == "commands came too late (1.0 s or more)"
    assert clock.take(0.25, Stage.HOLD, before=True).interrupted, "it still stands"
    assert not clock.cycle(0.25).interrupted, "it goes on"


def test_slow_commands_at_standstill_count_as_interruption(clock: Clock):
    clock.take(0.25, Stage.HOLD, before=False, left=False)
    assert not clock.take(0.25, Stage.HOLD, before=False).interrupted
    assert clock.take(0.25, Stage.HOLD, before=True).interrupted


def test_commands_before_the_maximum_gap_do_not_count_as_interruption(clock: Clock):
    assert not clock.take(MAX_INTERRUPTION, Stage.HOLD, before=False).interrupted
    assert not clock.cycle(2.0).interrupted


def test_resume_request_sent_earlier_than_new_commands_clears_the_interruption(clock: Clock):
    assert clock.take(2.0, Stage.HOLD, before=False).interrupted
    clock.watch.note_resume()
    assert not clock.watch.interrupted
    assert not clock.take(2.0, Stage.HOLD, before=True).interrupted


def test_slow_start_of_a_new_performance_does_not_count_as_interruption(clock: Clock):
    clock.take(9.0, Stage.HOLD, before=False, left=False)
    assert not clock.take(9.0, Stage.HOLD, before=False, fresh=True).interrupted
    assert not clock.take(9.0, Stage.HOLD, before=True).interrupted
    assert not clock.cycle(0.25).interrupted
    assert clock.take(2.0, Stage.HOLD, before=False).interrupted
