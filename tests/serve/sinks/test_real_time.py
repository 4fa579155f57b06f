"""Sinks in real time: which commands they get and when, what is sent again, and what a motion may not do."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.controller.learned_gains import Lesson
from kinesic.motion.trajectory import STEP, Trajectory, stay
from kinesic.planning.setup import Setup
from kinesic.serve.sinks import real_time
from kinesic.serve.sinks.real_time import KEPT, MeasuringSink, RealTimeSink, RealTwin, TeachingSink, is_steady
from kinesic.sim.servo_factors import NOMINAL, Factors

from ..simulated import Recorder, nod


def no_face(_: float) -> dict[str, float]:
    return {}


def followed(sink: RealTimeSink, setup: Setup, *times: float) -> list[list[float]]:
    """Times of the commands that come at each time."""
    motion, found = nod(setup, 0.1), []
    for time in times:
        sink.sink.commands.clear()
        sink.follow(motion, time, setup, no_face)
        found.append([round(command.time, 6) for command in sink.sink.commands])
    return found


def test_each_tick_is_handed_on_once_and_what_was_missed_follows(known: Setup):
    sink = RealTimeSink(Recorder())
    assert followed(sink, known, 0.0, 0.005, 0.0099, 0.01, 0.012, 0.05) == [
        [0.0],
        [],
        [],
        [0.01],
        [],
        [0.02, 0.03, 0.04, 0.05],
    ]


def test_a_tick_that_is_missed_by_rounding_is_not_missed(known: Setup):
    assert followed(RealTimeSink(Recorder()), known, 0.0, 0.1 + 0.2 - 0.2 - 1e-12)[-1][-1] == 0.1


def test_a_sink_may_have_its_commands_ahead_of_their_time(known: Setup):
    first, then = followed(RealTimeSink(Recorder(), ahead=0.05), known, 0.0, 0.01)
    assert first == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert then == [0.06]


def test_commands_are_those_of_the_motion_with_the_face_of_their_time(known: Setup):
    sink, motion = RealTimeSink(Recorder()), nod(known, 0.1)
    sink.follow(motion, 1.0, known, lambda time: {"smile": time})
    for command in sink.sink.commands[::10]:
        state = motion.at(command.time)
        assert np.allclose(command.angles, state.angles)
        assert np.allclose(command.speeds, state.speeds)
        assert np.allclose(command.accelerations, state.accelerations)
        assert command.face == {"smile": command.time}


def test_goals_lead_by_the_delay_of_the_sink(known: Setup):
    motion = nod(known, 0.0)
    prompt, late = RealTimeSink(Recorder()), RealTimeSink(Recorder(), delay=0.05)
    for sink in (prompt, late):
        sink.follow(motion, 1.0, known, no_face)
    middle = sink.sink.commands[100]
    lead = (late.sink.commands[100].goals - prompt.sink.commands[100].goals) * np.sign(middle.speeds)
    assert np.median(lead / np.abs(middle.speeds)) == pytest.approx(0.05, abs=0.03)


@pytest.mark.parametrize(("cut", "first"), [(0.123, 0.13), (0.12, 0.12), (0.1200000001, 0.12), (0.9, 0.51)])
def test_commands_are_sent_again_from_a_change_on(known: Setup, cut: float, first: float):
    sink = RealTimeSink(Recorder())
    sink.follow(nod(known, 0.1), 0.5, known, no_face)
    sink.repeat_from(cut)
    (times,) = followed(sink, known, 0.52)
    assert times[0] == first
    assert times == sorted(set(times))


def test_a_change_before_the_beginning_sends_all_again(known: Setup):
    sink = RealTimeSink(Recorder())
    sink.follow(nod(known, 0.1), 0.05, known, no_face)
    sink.repeat_from(0.02)
    sink.repeat_from(0.04)
    assert followed(sink, known, 0.05) == [[0.02, 0.03, 0.04, 0.05]], "the earliest counts"


class Learner:
    """Tells one lesson after some looks."""

    def __init__(self, lesson: Lesson) -> None:
        self.seen, self.closed, self._lessons = 0, 0, [None, lesson]

    def see(self, cycles) -> None:
        self.seen += len(cycles)

    def lesson(self) -> Lesson | None:
        return self._lessons.pop(0) if self._lessons else None

    def close(self) -> None:
        self.closed += 1


class Teaching(Recorder):
    def cycles(self) -> tuple[int, ...]:
        return (1, 2, 3)


@pytest.mark.parametrize(("why", "leads"), [("", True), ("servos were not read", False)])
def test_what_was_learned_leads_later_goals_and_what_was_not_learned_does_not(known: Setup, why: str, leads: bool):
    lesson = Lesson(Factors(gain=0.5, latency=0.03), why=why)
    learner = Learner(lesson)
    taught, plain = RealTimeSink(Teaching(), learner=learner), RealTimeSink(Recorder())
    motion = nod(known, 0.0)
    for sink in (taught, plain):
        for time in (0.0, 0.01, 2.0):
            sink.follow(motion, time, known, no_face)
    assert taught.lesson is lesson
    assert learner.seen == 9
    goals = [np.array([command.goals for command in sink.sink.commands]) for sink in (taught, plain)]
    assert np.array_equal(goals[0][:2], goals[1][:2])
    assert (np.abs(goals[0] - goals[1]).max() > 1e-3) == leads
    taught.close()
    assert (learner.closed, taught.sink.closed) == (1, 1)


def test_a_sink_that_cannot_teach_is_not_learned_from(known: Setup):
    learner = Learner(Lesson(NOMINAL))
    sink = RealTimeSink(Recorder(), learner=learner)
    sink.follow(nod(known, 0.0), 0.5, known, no_face)
    assert (learner.seen, sink.lesson) == (0, None)


def test_sinks_without_a_learner_close_alone(known: Setup):
    sink = RealTimeSink(Recorder())
    sink.close()
    assert sink.sink.closed == 1


def test_a_twin_tells_where_it_is_and_what_its_cycles_were(known: Setup):
    twin = RealTwin(known.robot)
    assert isinstance(twin, MeasuringSink)
    assert isinstance(twin, TeachingSink)
    sink = RealTimeSink(twin)
    sink.follow(nod(known, 0.0), 1.0, known, no_face)
    time, angles = twin.seen()
    assert time == pytest.approx(1.0)
    assert np.abs(angles - nod(known, 0.0).at(1.0).angles).max() < 0.1
    cycles = twin.cycles()
    assert [cycle.time for cycle in cycles] == pytest.approx(np.arange(101) / 100)
    assert np.array_equal(cycles[-1].angles, angles)
    assert (cycles[-1].taken == 1.0).all()
    assert cycles[-1].clock == 1.0
    assert cycles[-1].stage.runs
    assert twin.cycles() == (), "each is told once"
    twin.close()


def test_a_twin_forgets_what_it_measured(known: Setup, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(real_time, "KEPT", 10)
    twin, forgotten = RealTwin(known.robot), []
    monkeypatch.setattr(twin._twin, "forget", lambda: forgotten.append(len(twin.cycles())))
    RealTimeSink(twin).follow(stay(known.robot.skeleton.rest), 0.305, known, no_face)
    assert forgotten == [9, 10, 10]
    assert KEPT >= 100
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
def test_a_step_is_what_somebody_could_see(angle: float, speed: float, acceleration: float, steady: bool):
    """A motion is joined at 1 s to another one that is off by so much of one hinge."""
    times = (np.arange(203) - 1)[:, None] * STEP - 1.0
    still = np.zeros((203, 2))
    change = angle + speed * times + acceleration * (times**2 / 2 - STEP**2 / 6)
    moved = still.copy()
    moved[:, 1:] += change
    old, new = Trajectory(sealed(still), 0.0), Trajectory(sealed(moved), 0.0)
    assert is_steady(old, new, 1.0) == steady
    assert is_steady(new, old, 1.0) == steady
    assert is_steady(new, replace(new), 1.0)
