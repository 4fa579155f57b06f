"""Emergency stops of the control loop, and plans made before a stop."""

import numpy as np
import pytest

from kinesic.motion.trajectory import stay
from kinesic.realizer.feedback import Progress, ScheduledFeedback
from kinesic.serve.loop import STOP_COMPUTATION_TIME, TICK_PERIOD
from kinesic.serve.messages import Halted, LoopStart
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import Track

from .simulated import Recorder, Simulation, nod, proposal, verdict

STOP_DURATION = 0.5  # [s] time within which the stopped nod comes to rest
REST_TOLERANCE = 1e-9  # [rad] largest motion of a hinge at rest


def played(simulation: Simulation, stop_at: float, until: float) -> Recorder:
    """Play a nod from 0.1 s on and stop it."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield stop_at
        assert verdict(planner).accepted
        loop.emergency_stop()
        yield until

    simulation.run(script())
    return recorder


def test_emergency_stop_decelerates_within_limits_and_holds(simulation: Simulation):
    recorder = played(simulation, 1.0, 3.0)
    speeds = np.array([command.velocities for command in recorder.commands])
    times = np.array(recorder.times)
    assert np.abs(speeds[times <= 1.0]).max() > 0.1, "it moved before"
    assert np.abs(speeds[times >= 1.0 + STOP_DURATION]).max() < REST_TOLERANCE
    limits = simulation.setup.limits
    steps = np.abs(np.diff(speeds, axis=0)) / TICK_PERIOD
    assert (steps <= 1.001 * limits.acceleration + 1e-6).all()
    assert simulation.loop.is_stopped


def test_motion_is_unchanged_while_the_deceleration_is_computed(simulation: Simulation):
    recorder = played(simulation, 1.0, 1.2)
    planned = nod(simulation.setup, 0.1)
    kept = [command for command in recorder.commands if command.time <= 1.0 + STOP_COMPUTATION_TIME / 2]
    times = np.array([command.time for command in kept])
    assert (
        np.abs(np.array([command.angles for command in kept]) - planned.angles(times))[times > 0.1].max()
        < REST_TOLERANCE
    )


def test_deceleration_begins_within_a_few_ticks_of_an_emergency_stop(simulation: Simulation):
    """The delay must not grow with the duration of the motion."""
    recorder = played(simulation, 1.0, 3.0)
    planned = nod(simulation.setup, 0.1)
    away = np.abs(recorder.angles - planned.angles(np.array(recorder.times))).max(axis=1)
    left = next(time for time, distance in zip(recorder.times, away, strict=True) if distance > 1e-7 and time > 0.2)
    assert 1.0 < left <= 1.0 + STOP_COMPUTATION_TIME + 4 * TICK_PERIOD


def test_commands_sent_ahead_are_replaced_after_an_emergency_stop(simulation: Simulation):
    """The sink receives commands of the deceleration, none of past times."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder, ahead=0.5)])
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        recorder.commands.clear()
        loop.emergency_stop()
        yield 1.05

    simulation.run(script())
    times = np.array(recorder.times)
    again = times[np.searchsorted(times, times[0]) : np.argmax(times) + 1]
    assert 1.0 < again.min() <= 1.0 + STOP_COMPUTATION_TIME + 2 * TICK_PERIOD
    assert np.allclose(np.diff(again), TICK_PERIOD), "each tick once"
    final = recorder.commands[int(np.argmax(times))]
    assert np.abs(final.velocities).max() < REST_TOLERANCE


def test_emergency_stop_drops_pending_feedback_and_faces(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    planner = simulation.link()
    due, never = ScheduledFeedback(0.5, "<due/>"), ScheduledFeedback(1.5, Progress("b", "h", "stroke", 0.0), sender=3)

    def script():
        tracks = {"b": Track(0.0, {"x": np.ones(500)}, ())}
        planner.send(proposal(agenda=(due, never), tracks=tracks))
        yield 1.0
        assert simulation.effects.face(1.2) == {"x": 1.0}
        loop.emergency_stop()
        yield 1.05
        assert simulation.effects.face(1.2) == {}
        assert not loop.has_unfinished_blocks(3)
        yield 2.0

    simulation.run(script())
    assert [message for _, message, _ in simulation.told] == ["<due/>"]


def test_planner_receives_motion_and_time_of_the_stop(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        planner.recv()
        loop.emergency_stop()
        yield 1.1

    simulation.run(script())
    message = planner.recv()
    assert isinstance(message, Halted)
    assert message.stops == 1
    assert message.time == pytest.approx(1.0 + STOP_COMPUTATION_TIME, abs=2 * TICK_PERIOD)
    assert (message.motion.controls == loop.motion.controls).all()
    assert message.motion.start == loop.motion.start <= message.time - STOP_COMPUTATION_TIME + TICK_PERIOD
    assert message.motion.start >= message.time - STOP_COMPUTATION_TIME - TICK_PERIOD, "the past is not told"
    assert not planner.poll(0), "it is told once"


def test_several_emergency_stops_in_one_tick_are_executed_once(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.5
        for _ in range(3):
            loop.emergency_stop()
        assert loop.stop_count == 3
        yield 0.6
        planner.send(proposal(stops=3, motion=loop.motion, cut=0.7))
        yield 0.7
        loop.emergency_stop()
        yield 0.8

    simulation.run(script())
    halts = []
    while planner.poll(0):
        message = planner.recv()
        halts += [message.stops] if isinstance(message, Halted) else []
    assert halts == [3, 4]


@pytest.mark.parametrize("behind", [1, 2])
def test_plan_made_before_an_emergency_stop_is_discarded(simulation: Simulation, behind: int):
    """Neither motion nor feedback of such a plan is used."""
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.5
        for _ in range(behind):
            loop.emergency_stop()
        yield 1.0
        late = ScheduledFeedback(1.5, "<old/>", sender=4)
        motion = nod(simulation.setup, 1.2)
        planner.send(proposal(stops=0, now=1.0, cut=1.2, motion=motion, agenda=(late,), owed=frozenset({4})))
        yield 1.1
        answer = verdict(planner)
        assert not answer.accepted
        assert answer.stops == behind
        assert loop.is_stopped
        assert not loop.has_unfinished_blocks(4)
        planner.send(proposal(stops=behind, now=1.1, agenda=(ScheduledFeedback(1.6, "<new/>"),)))
        yield 3.0
        assert verdict(planner).accepted

    simulation.run(script())
    assert [message for _, message, _ in simulation.told] == ["<new/>"]
    assert np.ptp(recorder.angles, axis=0).max() < REST_TOLERANCE


def test_plan_sent_just_before_an_emergency_stop_is_discarded(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.5
        planner.send(proposal(motion=nod(simulation.setup, 0.6), cut=0.6))
        loop.emergency_stop()  # it counts before the loop executes it
        yield 0.7
        assert not verdict(planner).accepted
        assert loop.is_stopped

    simulation.run(script())
    assert np.ptp(loop.motion.controls, axis=0).max() < REST_TOLERANCE


def test_accepted_motion_planned_after_an_emergency_stop_ends_the_stopped_state(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.5
        loop.emergency_stop()
        yield 1.0
        assert loop.is_stopped
        planner.send(proposal(stops=1, now=1.0, agenda=()))
        yield 1.1
        assert verdict(planner).accepted
        assert loop.is_stopped, "feedback alone does not end it"
        planner.send(proposal(stops=1, now=1.1, cut=1.2, motion=nod(simulation.setup, 1.2)))
        yield 4.0
        assert verdict(planner).accepted
        assert not loop.is_stopped

    simulation.run(script())
    assert np.ptp(recorder.angles, axis=0).max() > 0.2


@pytest.mark.parametrize(("known_stops", "told"), [(0, True), (1, False)])
def test_new_planner_receives_only_emergency_stops_that_it_does_not_know(
    simulation: Simulation, known_stops: int, told: bool
):
    loop = simulation.make()
    planners = []

    def script():
        yield 0.5
        loop.emergency_stop()
        yield 1.0
        assert loop.snapshot().stops == 1
        planners.append(simulation.link(LoopStart(loop.motion, known_stops, ())))
        yield 1.1

    simulation.run(script())
    (planner,) = planners
    assert planner.poll(0) == told
    if told:
        message = planner.recv()
        assert (message.stops, message.motion.start) == (1, loop.motion.start)
        assert 0.5 < message.time < 1.0 + 2 * TICK_PERIOD


def test_blocked_planner_gets_the_last_stop_when_it_reads(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()
    stops, seen = 400, []

    def script():
        time = 0.0
        for _ in range(stops):
            time += 0.02
            yield time
            loop.emergency_stop()
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


def test_planner_started_after_an_emergency_stop_gets_the_stop_count_at_its_start(simulation: Simulation):
    loop = simulation.make()

    def script():
        yield 0.2
        loop.emergency_stop()
        yield 0.4
        begin = loop.snapshot()
        assert (begin.stops, begin.agenda) == (1, ())
        assert begin.motion is loop.motion
        planner = simulation.link(begin)
        yield 0.5
        assert not planner.poll(0), "it knows of it"

    simulation.run(script())
    assert loop.is_stopped


def test_emergency_stop_stops_the_robot_although_the_planner_is_dead(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 0.2
        planner.close()
        loop.emergency_stop()
        yield 0.4
        loop.emergency_stop()
        yield 0.6

    simulation.run(script())
    assert not loop.has_failed
    assert simulation.news == [None]
    assert loop.is_stopped


def test_emergency_stop_at_rest_holds_the_posture(simulation: Simulation):
    loop = simulation.make()
    rest = simulation.setup.robot.skeleton.rest

    def script():
        yield 5.0
        loop.emergency_stop()
        yield 5.1

    simulation.run(script())
    assert np.abs(loop.motion.controls - rest).max() < REST_TOLERANCE
    assert loop.motion.end < 5.3
    assert (stay(rest).controls[0] == loop.motion.controls[0]).all()
