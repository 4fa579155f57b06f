"""What is told of servos that fail, and of how long a motion was interrupted."""

import pytest

from kinesic.hardware.protocol.registers import HardwareError
from kinesic.hardware.supervisor.failures import FailureWatch, InterruptionWatch
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.state_machine import Stage

from .judged import Room

STARTLE = 0.5  # [s]


class Watched:
    """A watch for failures, and what it wrote into the log."""

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


def test_a_failure_is_told_once_and_by_the_hinges_names(watched: Watched):
    watched.room.records["hardware_error"][1] = HardwareError.OVERLOAD.value
    assert watched.err(3, HardwareError.OVERHEATING) == ("failed",)
    assert watched.log == [("failed", "torsion, l_twist: shut down, or cannot move")]
    assert watched.look() == ()
    assert len(watched.log) == 1


def test_a_hinge_whose_servos_fail_together_is_named_once(watched: Watched):
    watched.room.records["hardware_error"][0] = HardwareError.OVERLOAD.value
    assert watched.err(1, HardwareError.OVERLOAD) == ("failed",)
    assert watched.log == [("failed", "torsion: shut down, or cannot move")]


def test_what_is_so_from_the_first_cycle_on_is_told(room: Room, manifest: Manifest):
    first = Watched(room, manifest)
    room.records["hardware_error"][1] = HardwareError.OVERLOAD.value
    assert first.err(0, HardwareError.VOLTAGE) == ("failed",)
    assert [kind for kind, _ in first.log] == ["failed", "supply"]


def test_each_further_failure_is_told_by_itself(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    assert watched.err(4, HardwareError.OVERLOAD) == ("failed",)
    assert watched.log[1:] == [("failed", "r_flexion: shut down, or cannot move")]


def test_who_fails_again_is_told_again(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    assert watched.err(1, None) == ("mended",)
    assert watched.look() == ()
    assert watched.err(1, HardwareError.OVERLOAD) == ("failed",)
    assert len(watched.log) == 2


def test_one_may_fail_while_another_is_well_again(watched: Watched):
    watched.err(1, HardwareError.OVERLOAD)
    watched.room.records["hardware_error"][1] = 0
    assert watched.err(2, HardwareError.OVERLOAD) == ("failed", "mended")


def test_who_is_heard_again_is_mended_and_had_not_failed(watched: Watched):
    watched.room.recent[2] = False
    assert watched.look() == ()
    watched.room.recent[2] = True
    assert watched.look() == ("mended",)
    assert watched.log == []


def test_who_is_heard_again_but_has_failed_is_not_mended(watched: Watched):
    watched.room.recent[2] = False
    watched.look()
    watched.room.recent[2] = True
    assert watched.err(2, HardwareError.OVERLOAD) == ("failed",)


def test_a_weak_supply_is_told_once_with_its_lowest_voltage_and_is_no_event(watched: Watched):
    watched.room.records["volts"] = [95, 94, 93, 95, 95]
    assert watched.err(0, HardwareError.VOLTAGE) == ()
    assert watched.log == [("supply", "9.3 V are not enough: the robot folds")]
    assert watched.err(1, HardwareError.VOLTAGE) == ()
    assert len(watched.log) == 1
    watched.room.records["hardware_error"] = 0
    watched.look()
    watched.err(1, HardwareError.VOLTAGE)
    assert len(watched.log) == 2


class Clock:
    """A watch for interruptions, and its time."""

    def __init__(self) -> None:
        self.time = 0.0
        self.watch = InterruptionWatch(STARTLE)

    def cycle(self, seconds: float, *, well: bool = True) -> InterruptionWatch:
        """One cycle of a performance, so long after the one before: commands are taken, then servos are judged."""
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


def test_before_the_first_cycle_nothing_is_interrupted():
    watch = InterruptionWatch(STARTLE)
    assert (watch.interrupted, watch.unwell) == (False, 0.0)
    watch.note_commands(0.75, stage=Stage.HOLD, before=False, left=True, fresh=False)
    assert (watch.interrupted, watch.unwell) == (True, 0.75)
    assert watch.describe("") == "this process stood still (0.8 s and more)"


def test_all_is_well(clock: Clock):
    assert not clock.cycle(0.25).interrupted
    assert clock.watch.unwell == 0.0


def test_servos_that_are_unwell_for_longer_than_a_startle_interrupt(clock: Clock):
    assert not clock.cycle(0.25, well=False).interrupted
    assert not clock.cycle(0.25, well=False).interrupted
    assert clock.watch.unwell == STARTLE
    assert clock.cycle(0.25, well=False).interrupted
    assert clock.watch.unwell == 0.75
    assert clock.watch.describe("l_twist: silent") == "l_twist: silent (0.8 s and more)"
    assert not clock.cycle(0.25).interrupted


def test_a_process_that_stood_still_interrupts_before_servos_are_judged(clock: Clock):
    clock.watch.note_commands(clock.time + 3.0, stage=Stage.ACTIVE, before=True, left=True, fresh=False)
    assert clock.watch.interrupted
    assert clock.watch.describe("") == "this process stood still (3.0 s and more)"


def test_commands_that_go_on_after_a_long_time_without_interrupt(clock: Clock):
    for _ in range(3):
        assert not clock.take(0.25, Stage.HOLD, before=False, left=False).interrupted
    assert clock.take(0.25, Stage.HOLD, before=False).interrupted
    assert clock.watch.describe("l_twist: silent") == "commands came too late (1.0 s and more)"
    assert clock.take(0.25, Stage.HOLD, before=True).interrupted, "it still stands"
    assert not clock.cycle(0.25).interrupted, "it goes on"


def test_commands_that_trickle_in_while_it_stands_interrupt_as_well(clock: Clock):
    clock.take(0.25, Stage.HOLD, before=False, left=False)
    assert not clock.take(0.25, Stage.HOLD, before=False).interrupted
    assert clock.take(0.25, Stage.HOLD, before=True).interrupted


def test_commands_that_go_on_in_time_do_not(clock: Clock):
    assert not clock.take(STARTLE, Stage.HOLD, before=False).interrupted
    assert not clock.cycle(2.0).interrupted


def test_who_consents_may_wait_for_commands(clock: Clock):
    assert clock.take(2.0, Stage.HOLD, before=False).interrupted
    clock.watch.note_consent()
    assert not clock.watch.interrupted
    assert not clock.take(2.0, Stage.HOLD, before=True).interrupted


def test_a_new_performance_is_no_interruption_however_long_its_first_commands_take(clock: Clock):
    clock.take(9.0, Stage.HOLD, before=False, left=False)
    assert not clock.take(9.0, Stage.HOLD, before=False, fresh=True).interrupted
    assert not clock.take(9.0, Stage.HOLD, before=True).interrupted
    assert not clock.cycle(0.25).interrupted
    assert clock.take(2.0, Stage.HOLD, before=False).interrupted
