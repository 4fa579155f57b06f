"""Emergency stops of the live loop, and plans that were made before one."""

import numpy as np
import pytest

from kinesic.motion.trajectory import stay
from kinesic.realizer.feedback import Progress, ScheduledFeedback
from kinesic.serve.loop import GRACE, PERIOD
from kinesic.serve.messages import Halted, LoopStart
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import Track

from .simulated import Recorder, Simulation, nod, proposal, verdict

STOPPED_AFTER = 0.5  # [s] in which such a motion is at rest
STILL = 1e-9  # [rad]


def played(simulation: Simulation, stop_at: float, until: float) -> Recorder:
    """Plays a nod from 0.1 s on, and stops it."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield stop_at
        assert verdict(planner).accepted
        loop.halt()
        yield until

    simulation.run(script())
    return recorder


def test_a_stop_ends_a_motion_within_its_limits_and_the_body_holds(simulation: Simulation):
    recorder = played(simulation, 1.0, 3.0)
    speeds = np.array([command.speeds for command in recorder.commands])
    times = np.array(recorder.times)
    assert np.abs(speeds[times <= 1.0]).max() > 0.1, "it moved before"
    assert np.abs(speeds[times >= 1.0 + STOPPED_AFTER]).max() < STILL
    limits = simulation.setup.limits
    steps = np.abs(np.diff(speeds, axis=0)) / PERIOD
    assert (steps <= 1.001 * limits.acceleration + 1e-6).all()
    assert simulation.loop.halted


def test_what_is_played_before_the_way_to_rest_is_found_stays_as_planned(simulation: Simulation):
    recorder = played(simulation, 1.0, 1.2)
    planned = nod(simulation.setup, 0.1)
    kept = [command for command in recorder.commands if command.time <= 1.0 + GRACE / 2]
    times = np.array([command.time for command in kept])
    assert np.abs(np.array([command.angles for command in kept]) - planned.angles(times))[times > 0.1].max() < STILL


def test_a_stop_comes_soon(simulation: Simulation):
    """The way to rest begins some ticks after the request, however long the motion would have gone on."""
    recorder = played(simulation, 1.0, 3.0)
    planned = nod(simulation.setup, 0.1)
    away = np.abs(recorder.angles - planned.angles(np.array(recorder.times))).max(axis=1)
    left = next(time for time, distance in zip(recorder.times, away, strict=True) if distance > 1e-7 and time > 0.2)
    assert 1.0 < left <= 1.0 + GRACE + 4 * PERIOD


def test_commands_that_are_out_already_are_replaced_after_a_stop(simulation: Simulation):
    """A sink that gets commands ahead of their time gets those of the way to rest, from no time that has passed."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder, ahead=0.5)])
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        recorder.commands.clear()
        loop.halt()
        yield 1.05

    simulation.run(script())
    times = np.array(recorder.times)
    again = times[np.searchsorted(times, times[0]) : np.argmax(times) + 1]
    assert 1.0 < again.min() <= 1.0 + GRACE + 2 * PERIOD
    assert np.allclose(np.diff(again), PERIOD), "each tick once"
    final = recorder.commands[int(np.argmax(times))]
    assert np.abs(final.speeds).max() < STILL


def test_a_stop_drops_feedback_and_faces(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    planner = simulation.link()
    due, never = ScheduledFeedback(0.5, "<due/>"), ScheduledFeedback(1.5, Progress("b", "h", "stroke", 0.0), sender=3)

    def script():
        tracks = {"b": Track(0.0, {"x": np.ones(500)}, ())}
        planner.send(proposal(agenda=(due, never), tracks=tracks))
        yield 1.0
        assert simulation.effects.face(1.2) == {"x": 1.0}
        loop.halt()
        yield 1.05
        assert simulation.effects.face(1.2) == {}
        assert not loop.owes(3)
        yield 2.0

    simulation.run(script())
    assert [message for _, message, _ in simulation.told] == ["<due/>"]


def test_the_planner_is_told_the_motion_of_the_stop_and_when_it_was(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        planner.recv()
        loop.halt()
        yield 1.1

    simulation.run(script())
    told = planner.recv()
    assert isinstance(told, Halted)
    assert told.stops == 1
    assert told.time == pytest.approx(1.0 + GRACE, abs=2 * PERIOD)
    assert (told.motion.controls == loop.motion.controls).all()
    assert told.motion.start == loop.motion.start <= told.time - GRACE + PERIOD
    assert told.motion.start >= told.time - GRACE - PERIOD, "the past is not told"
    assert not planner.poll(0), "it is told once"


def test_several_stops_in_one_tick_are_made_once_and_each_counts(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.5
        for _ in range(3):
            loop.halt()
        assert loop.stops == 3
        yield 0.6
        planner.send(proposal(stops=3, motion=loop.motion, cut=0.7))
        yield 0.7
        loop.halt()
        yield 0.8

    simulation.run(script())
    halts = []
    while planner.poll(0):
        message = planner.recv()
        halts += [message.stops] if isinstance(message, Halted) else []
    assert halts == [3, 4]


@pytest.mark.parametrize("behind", [1, 2])
def test_a_plan_made_before_a_stop_is_discarded(simulation: Simulation, behind: int):
    """Neither its motion nor its feedback, however well they would fit."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.5
        for _ in range(behind):
            loop.halt()
        yield 1.0
        late = ScheduledFeedback(1.5, "<old/>", sender=4)
        motion = nod(simulation.setup, 1.2)
        planner.send(proposal(stops=0, now=1.0, cut=1.2, motion=motion, agenda=(late,), owed=frozenset({4})))
        yield 1.1
        answer = verdict(planner)
        assert not answer.accepted
        assert answer.stops == behind
        assert loop.halted
        assert not loop.owes(4)
        planner.send(proposal(stops=behind, now=1.1, agenda=(ScheduledFeedback(1.6, "<new/>"),)))
        yield 3.0
        assert verdict(planner).accepted

    simulation.run(script())
    assert [message for _, message, _ in simulation.told] == ["<new/>"]
    assert np.ptp(recorder.angles, axis=0).max() < STILL


def test_a_plan_that_is_on_its_way_when_the_stop_comes_is_discarded_in_the_same_tick(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.5
        planner.send(proposal(motion=nod(simulation.setup, 0.6), cut=0.6))
        loop.halt()  # it counts before the loop makes it
        yield 0.7
        assert not verdict(planner).accepted
        assert loop.halted

    simulation.run(script())
    assert np.ptp(loop.motion.controls, axis=0).max() < STILL


def test_a_plan_made_after_the_stop_ends_it(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.5
        loop.halt()
        yield 1.0
        assert loop.halted
        planner.send(proposal(stops=1, now=1.0, agenda=()))
        yield 1.1
        assert verdict(planner).accepted
        assert loop.halted, "feedback alone does not end it"
        planner.send(proposal(stops=1, now=1.1, cut=1.2, motion=nod(simulation.setup, 1.2)))
        yield 4.0
        assert verdict(planner).accepted
        assert not loop.halted

    simulation.run(script())
    assert np.ptp(recorder.angles, axis=0).max() > 0.2


@pytest.mark.parametrize(("known_stops", "told"), [(0, True), (1, False)])
def test_a_planner_that_was_started_before_a_stop_is_told_it(simulation: Simulation, known_stops: int, told: bool):
    loop = simulation.make()
    planners = []

    def script():
        yield 0.5
        loop.halt()
        yield 1.0
        assert loop.beginning().stops == 1
        planners.append(simulation.link(LoopStart(loop.motion, known_stops, ())))
        yield 1.1

    simulation.run(script())
    (planner,) = planners
    assert planner.poll(0) == told
    if told:
        message = planner.recv()
        assert (message.stops, message.motion.start) == (1, loop.motion.start)
        assert 0.5 < message.time < 1.0 + 2 * PERIOD


def test_a_planner_that_reads_nothing_gets_the_last_stop_as_soon_as_it_reads(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()
    stops, seen = 400, []

    def script():
        time = 0.0
        for _ in range(stops):
            time += 0.02
            yield time
            loop.halt()
        yield time + 0.1
        while planner.poll(0):
            seen.append(planner.recv().stops)
        assert seen[-1] < stops, "its pipe was full"
        yield time + 0.2
        while planner.poll(0):
            seen.append(planner.recv().stops)

    simulation.run(script())
    assert seen[-1] == stops
    assert seen == sorted(set(seen))


def test_a_stop_without_a_planner_holds_and_the_next_planner_begins_from_there(simulation: Simulation):
    loop = simulation.make()

    def script():
        yield 0.2
        loop.halt()
        yield 0.4
        begin = loop.beginning()
        assert (begin.stops, begin.agenda) == (1, ())
        assert begin.motion is loop.motion
        planner = simulation.link(begin)
        yield 0.5
        assert not planner.poll(0), "it knows of it"

    simulation.run(script())
    assert loop.halted


def test_a_planner_that_has_died_does_not_disturb_a_stop(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.2
        planner.close()
        loop.halt()
        yield 0.4
        loop.halt()
        yield 0.6

    simulation.run(script())
    assert not loop.failed
    assert simulation.news == [None]
    assert loop.halted


def test_a_body_at_rest_is_stopped_where_it_is(simulation: Simulation):
    loop = simulation.make()
    rest = simulation.setup.robot.skeleton.rest

    def script():
        yield 5.0
        loop.halt()
        yield 5.1

    simulation.run(script())
    assert np.abs(loop.motion.controls - rest).max() < STILL
    assert loop.motion.end < 5.3
    assert (stay(rest).controls[0] == loop.motion.controls[0]).all()
