"""Real-time sinks: times of commands, resending, and continuity of motions."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.impact_policy import find_policy
from kinesic.controller.learned_gains import Identification
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, stay
from kinesic.planning.setup import Setup
from kinesic.serve.sinks import real_time
from kinesic.serve.sinks.real_time import LOG_CAPACITY, MeasuringSink, RealTimeSink, RealTwin, TelemetrySink, is_steady
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

from ..simulated import Recorder, nod


def no_face(_: float) -> dict[str, float]:
    return {}


def followed(sink: RealTimeSink, setup: Setup, *times: float) -> list[list[float]]:
    """Return the time stamps [s] of the commands sent in each call."""
    motion, results = nod(setup, 0.1), []
    for time in times:
        sink.sink.commands.clear()
        sink.follow(motion, time, setup, no_face)
        results.append([round(command.time, 6) for command in sink.sink.commands])
    return results


def test_sink_gets_each_command_once_including_commands_missed_during_a_delay(known: Setup):
    sink = RealTimeSink(Recorder())
    assert followed(sink, known, 0.0, 0.005, 0.0099, 0.01, 0.012, 0.05) == [
        [0.0],
        [],
        [],
        [0.01],
        [],
        [0.02, 0.03, 0.04, 0.05],
    ]


def test_rounding_of_command_times_skips_no_command(known: Setup):
    assert followed(RealTimeSink(Recorder()), known, 0.0, 0.1 + 0.2 - 0.2 - 1e-12)[-1][-1] == 0.1


def test_sink_that_needs_commands_ahead_gets_each_command_50_ms_before_its_time(known: Setup):
    first, then = followed(RealTimeSink(Recorder(), ahead=0.05), known, 0.0, 0.01)
    assert first == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert then == [0.06]


def test_commands_of_the_server_contain_motion_and_face_of_their_time(known: Setup):
    sink, motion = RealTimeSink(Recorder()), nod(known, 0.1)
    sink.follow(motion, 1.0, known, lambda time: {"smile": time})
    for command in sink.sink.commands[::10]:
        state = motion.at(command.time)
        assert np.allclose(command.angles, state.angles)
        assert np.allclose(command.velocities, state.velocities)
        assert np.allclose(command.accelerations, state.accelerations)
        assert command.face == {"smile": command.time}


def test_setpoints_compensate_the_sink_delay(known: Setup):
    motion = nod(known, 0.0)
    prompt, late = RealTimeSink(Recorder()), RealTimeSink(Recorder(), delay=0.05)
    for sink in (prompt, late):
        sink.follow(motion, 1.0, known, no_face)
    middle = sink.sink.commands[100]
    lead = (late.sink.commands[100].setpoints - prompt.sink.commands[100].setpoints) * np.sign(middle.velocities)
    assert np.median(lead / np.abs(middle.velocities)) == pytest.approx(0.05, abs=0.03)


@pytest.mark.parametrize(("cut", "first"), [(0.123, 0.13), (0.12, 0.12), (0.1200000001, 0.12), (0.9, 0.51)])
def test_sink_resends_commands_from_the_first_time_after_a_motion_change(known: Setup, cut: float, first: float):
    sink = RealTimeSink(Recorder())
    sink.follow(nod(known, 0.1), 0.5, known, no_face)
    sink.repeat_from(cut)
    (times,) = followed(sink, known, 0.52)
    assert times[0] == first
    assert times == sorted(set(times))


def test_after_two_motion_changes_commands_are_resent_from_the_earliest_change(known: Setup):
    sink = RealTimeSink(Recorder())
    sink.follow(nod(known, 0.1), 0.05, known, no_face)
    sink.repeat_from(0.02)
    sink.repeat_from(0.04)
    assert followed(sink, known, 0.05) == [[0.02, 0.03, 0.04, 0.05]], "the earliest counts"


class Learner:
    """Stub learner that returns one result after some calls."""

    def __init__(self, lesson: Identification) -> None:
        self.seen, self.closed, self._lessons = 0, 0, [None, lesson]

    def see(self, cycles) -> None:
        self.seen += len(cycles)

    def lesson(self) -> Identification | None:
        return self._lessons.pop(0) if self._lessons else None

    def close(self) -> None:
        self.closed += 1


class Teaching(Recorder):
    def take_cycles(self) -> tuple[int, ...]:
        return (1, 2, 3)


@pytest.mark.parametrize(("why", "leads"), [("", True), ("no servo telemetry was recorded", False)])
def test_only_successful_servo_identification_changes_later_setpoints(known: Setup, why: str, leads: bool):
    lesson = Identification(Factors(gain=0.5, latency=0.03), why=why)
    learner = Learner(lesson)
    taught, plain = RealTimeSink(Teaching(), learner=learner), RealTimeSink(Recorder())
    motion = nod(known, 0.0)
    for sink in (taught, plain):
        for time in (0.0, 0.01, 2.0):
            sink.follow(motion, time, known, no_face)
    assert taught.lesson is lesson
    assert learner.seen == 9
    goals = [np.array([command.setpoints for command in sink.sink.commands]) for sink in (taught, plain)]
    assert np.array_equal(goals[0][:2], goals[1][:2])
    assert (np.abs(goals[0] - goals[1]).max() > 1e-3) == leads
    taught.close()
    assert (learner.closed, taught.sink.closed) == (1, 1)


def test_sink_that_reports_no_cycles_provides_no_identification_data(known: Setup):
    learner = Learner(Identification(NOMINAL_FACTORS))
    sink = RealTimeSink(Recorder(), learner=learner)
    sink.follow(nod(known, 0.0), 0.5, known, no_face)
    assert (learner.seen, sink.lesson) == (0, None)


def test_sink_that_identifies_no_servo_parameters_can_be_closed(known: Setup):
    sink = RealTimeSink(Recorder())
    sink.close()
    assert sink.sink.closed == 1


def test_real_time_twin_returns_measured_angles_and_supervisor_cycles(known: Setup):
    twin = RealTwin(known.robot)
    assert isinstance(twin, MeasuringSink)
    assert isinstance(twin, TelemetrySink)
    sink = RealTimeSink(twin)
    sink.follow(nod(known, 0.0), 1.0, known, no_face)
    time, angles = twin.measurement()
    assert time == pytest.approx(1.0)
    assert np.abs(angles - nod(known, 0.0).at(1.0).angles).max() < 0.1
    cycles = twin.take_cycles()
    assert [cycle.time for cycle in cycles] == pytest.approx(np.arange(101) / 100)
    assert np.array_equal(cycles[-1].angles, angles)
    assert (cycles[-1].taken == 1.0).all()
    assert cycles[-1].clock == 1.0
    assert cycles[-1].stage.runs
    assert twin.take_cycles() == (), "each is told once"
    twin.close()


def test_real_time_twin_is_measured_at_rest_before_its_first_command_and_closed_with_its_sink(known, monkeypatch):
    twin, closed = RealTwin(known.robot), []
    time, angles = twin.measurement()
    assert time == 0.0
    assert angles == pytest.approx(known.robot.skeleton.rest, abs=2e-3)  # a servo tick is 1.5 mrad
    close = twin._twin.close
    monkeypatch.setattr(twin._twin, "close", lambda: closed.append(close()))
    RealTimeSink(twin).close()
    assert closed == [None]


def test_real_time_twin_drops_old_measurements(known: Setup, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(real_time, "LOG_CAPACITY", 10)
    twin, forgotten = RealTwin(known.robot), []
    monkeypatch.setattr(twin._twin, "forget", lambda: forgotten.append(len(twin.take_cycles())))
    RealTimeSink(twin).follow(stay(known.robot.skeleton.rest), 0.305, known, no_face)
    assert forgotten == [9, 10, 10]
    assert LOG_CAPACITY >= 100
    twin.close()


@pytest.mark.parametrize(
    ("angle", "speed", "acceleration", "steady"),
    [
        (0.0, 0.0, 0.0, True),
        (0.5e-6, 0.0, 0.0, True),
        (2e-6, 0.0, 0.0, False),
        (0.0, 0.5e-4, 0.0, True),
        (0.0, 2e-4, 0.0, False),
        (0.0, 0.0, 0.05, True),
        (0.0, 0.0, 0.2, False),
    ],
)
def test_motion_change_with_a_step_in_angle_velocity_or_acceleration_is_detected_as_unsteady(
    angle: float, speed: float, acceleration: float, steady: bool
):
    """At 1 s a motion continues as another one with an offset in one hinge."""
    times = (np.arange(203) - 1)[:, None] * KNOT_INTERVAL - 1.0
    still = np.zeros((203, 2))
    change = angle + speed * times + acceleration * (times**2 / 2 - KNOT_INTERVAL**2 / 6)
    moved = still.copy()
    moved[:, 1:] += change
    old, new = Trajectory(sealed(still), 0.0), Trajectory(sealed(moved), 0.0)
    assert is_steady(old, new, 1.0) == steady
    assert is_steady(new, old, 1.0) == steady
    assert is_steady(new, replace(new), 1.0)


class CappedRecorder(Recorder):
    """Sink that records caps and the number of commands before them."""

    pace = 0.1

    def __init__(self) -> None:
        super().__init__()
        self.caps: list[tuple[int, ServoCaps]] = []

    def limit(self, caps: ServoCaps, /) -> None:
        self.caps.append((len(self.commands), caps))


def test_sink_gets_caps_at_once_after_the_first_commands_of_each_new_motion_near_people(known: Setup):
    near = replace(known, policy=find_policy("adult"))
    sink, motion = RealTimeSink(CappedRecorder(), ahead=0.5), nod(known, 0.1)
    for now in (0.0, 0.2):
        sink.follow(motion, now, near, no_face)
    sink.repeat_from(0.3)
    sink.follow(stay(known.robot.skeleton.rest), 0.3, near, no_face)
    (first, nodding), (later, still) = sink.sink.caps
    assert (first, later) == (51, 122)
    moving = int(np.abs(nodding.velocities - still.velocities).argmax())
    assert nodding.velocities[moving] > 1.5 * still.velocities[moving]
    far = 0.3 + real_time.CAPPED_TICKS / 100
    sink.follow(sink._capped_motion, far + 0.1, near, no_face)
    assert len(sink.sink.caps) == 3


def test_sink_gets_no_caps_without_people(known: Setup):
    sink = RealTimeSink(CappedRecorder())
    sink.follow(nod(known, 0.1), 0.5, known, no_face)
    assert sink.sink.caps == []
