"""Proposals to the control loop: acceptance and feedback times."""

import re
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.realizer.feedback import Progress, ScheduledFeedback
from kinesic.serve.loop import MAX_ARRIVAL_WAIT, TICK_PERIOD
from kinesic.serve.sinks.real_time import RealTimeSink

from .simulated import Recorder, Simulation, nod, proposal, verdict


class Body(Recorder):
    """Stub body that follows commands with a delay and measures its angles."""

    def __init__(self, late: float) -> None:
        super().__init__()
        self._late = late

    def measurement(self):
        if not self.commands:
            return None
        now = self.commands[-1].time
        then = min(self.commands, key=lambda command: abs(command.time - (now - self._late)))
        return now, then.angles


class Frozen(Recorder):
    """Stub body that never moves."""

    def measurement(self):
        return (self.commands[-1].time, self.commands[0].angles) if self.commands else None


def sent(simulation: Simulation) -> list[str]:
    return [message for _, message, _ in simulation.told]


def test_control_loop_plays_a_proposed_motion_from_its_splice_time(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()
    motion = nod(simulation.setup, 0.5)

    def script():
        yield 0.2
        planner.send(proposal(motion=motion, cut=0.5, idles=True, owed=frozenset({3})))
        yield 3.0
        answer = verdict(planner)
        assert answer.accepted
        assert answer.stops == 0
        assert answer.time == pytest.approx(0.2, abs=2 * TICK_PERIOD)

    simulation.run(script())
    assert loop.is_idling
    assert loop.has_unfinished_blocks(3)
    assert not loop.has_unfinished_blocks(4)
    assert np.allclose(recorder.angles, motion.angles(np.array(recorder.times)), atol=1e-9)


@pytest.mark.parametrize(("early", "accepted"), [(0.05, False), (0.02, False), (-0.05, True)])
def test_control_loop_refuses_a_plan_proposal_that_changes_sent_commands(
    simulation: Simulation, early: float, accepted: bool
):
    """This holds even for a continuous transition."""
    loop = simulation.make()
    planner = simulation.link()
    motion = nod(simulation.setup, 2.0)

    def script():
        yield 1.0
        planner.send(proposal(motion=motion, cut=1.0 - early, agenda=(ScheduledFeedback(1.5, "<new/>"),)))
        yield 1.6
        assert verdict(planner).accepted == accepted

    simulation.run(script())
    assert (loop.motion.end == motion.end) == accepted
    assert sent(simulation) == ["<new/>"] * accepted


def test_control_loop_accepts_a_plan_proposal_that_begins_at_the_last_sent_command(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()

    def script():
        yield 1.003
        planner.send(proposal())
        yield 1.005
        out = verdict(planner).time
        planner.send(proposal(motion=nod(simulation.setup, 2.0), cut=out))
        yield 1.007
        assert verdict(planner).accepted

    simulation.run(script())
    assert loop.motion.end > 2.0


@pytest.mark.parametrize("parts", ["angles", "velocities", "accelerations"])
def test_control_loop_refuses_the_proposal_of_a_discontinuous_motion(simulation: Simulation, parts: str):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()
    before = loop.motion
    rest = simulation.setup.robot.skeleton.rest
    knots = np.arange(203)[:, None] * 0.01
    change = {
        "angles": 1e-3 + 0 * knots,
        "velocities": 0.01 * (knots - 1.02),
        "accelerations": 0.5 * (knots - 1.02) ** 2 - KNOT_INTERVAL**2 / 6,  # at 1.01 s it has arrived and rests
    }
    jump = Trajectory(sealed(rest + change[parts] * np.ones(len(rest))), 0.0, 0.0)

    def script():
        yield 1.01
        planner.send(proposal(motion=jump, cut=1.02, agenda=(ScheduledFeedback(1.2, "<new/>"),)))
        yield 1.5
        assert not verdict(planner).accepted

    simulation.run(script())
    assert loop.motion is before
    assert np.ptp(recorder.angles, axis=0).max() < 1e-9
    assert not simulation.told


def test_commands_sent_ahead_are_resent_from_the_splice_time(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder, ahead=0.5)])
    planner = simulation.link()
    motion = nod(simulation.setup, 1.2)

    def script():
        yield 1.0
        recorder.commands.clear()
        planner.send(proposal(motion=motion, cut=1.2))
        yield 2.0

    simulation.run(script())
    times = np.array(recorder.times)
    assert times[times < 1.45].min() == pytest.approx(1.2, abs=TICK_PERIOD), "what comes before the cut stays"
    last = {round(command.time, 3): command.angles for command in recorder.commands}
    assert np.allclose(list(last.values()), motion.angles(np.array(list(last))), atol=1e-6)


def test_proposal_with_a_past_splice_time_resends_no_past_commands(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 1.003
        planner.send(proposal())
        yield 1.005
        out = verdict(planner).time
        recorder.commands.clear()
        planner.send(proposal(motion=nod(simulation.setup, 2.0), cut=out))
        yield 1.3

    simulation.run(script())
    assert min(recorder.times) > 1.0
    assert np.allclose(np.diff(recorder.times), TICK_PERIOD)


def test_feedback_is_sent_once_in_order_when_due(simulation: Simulation):
    simulation.make()
    planner = simulation.link()
    agenda = tuple(ScheduledFeedback(time, f"<at{time}/>", sender=5) for time in (0.9, 0.3, 0.6))

    def script():
        planner.send(proposal(agenda=agenda))
        yield 0.5
        planner.send(proposal(now=0.2, agenda=agenda))  # computed before the first one was sent
        yield 2.0

    simulation.run(script())
    assert sent(simulation) == ["<at0.3/>", "<at0.6/>", "<at0.9/>"]
    assert [sender for *_, sender in simulation.told] == [5, 5, 5]
    for (when, *_), due in zip(simulation.told, (0.3, 0.6, 0.9), strict=True):
        assert 0.0 <= when - due < 2 * TICK_PERIOD


def test_feedback_withdrawn_by_the_planner_is_not_sent(simulation: Simulation):
    simulation.make()
    planner = simulation.link()

    def script():
        planner.send(proposal(now=0.1, agenda=(ScheduledFeedback(1.0, "<old/>"),)))
        yield 0.5
        planner.send(proposal(now=0.5, agenda=(ScheduledFeedback(1.2, "<new/>"),)))
        yield 2.0

    simulation.run(script())
    assert sent(simulation) == ["<new/>"]


def test_client_counts_as_unfinished_until_its_pending_feedback_is_sent(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()
    owed = []

    def script():
        planner.send(proposal(agenda=(ScheduledFeedback(1.0, "<x/>", sender=2),)))
        for time in (0.5, 1.5):
            yield time
            owed.append((loop.has_unfinished_blocks(2), loop.has_unfinished_blocks(1)))

    simulation.run(script())
    assert owed == [(True, False), (False, False)]


STROKE = Progress("b", "h", "stroke", 0.0)


def stroke_sent(simulation: Simulation, body: Recorder, **changes: object) -> tuple[float, str]:
    """Return send time and message of a block's stroke planned at 0.6 s."""
    simulation.make([RealTimeSink(body)])
    planner = simulation.link()
    every = np.ones(len(simulation.setup.robot.drives), dtype=bool)
    parts = {"moving": {("b", "h"): every}, "agenda": (ScheduledFeedback(1.0, STROKE),)} | changes

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1, **parts))
        yield 2.0

    simulation.run(script())
    ((when, message, _),) = simulation.told
    return when, message


@pytest.mark.parametrize("late", [0.03, 0.06])
def test_progress_feedback_contains_the_measured_arrival_time(simulation: Simulation, late: float):
    when, message = stroke_sent(simulation, Body(late))
    (measured,) = re.findall('measuredGlobalTime="([^"]*)"', message)
    assert float(measured) == pytest.approx(1.0 + late, abs=TICK_PERIOD)
    assert 1.0 + late - TICK_PERIOD <= when <= 1.0 + late + 3 * TICK_PERIOD


def test_feedback_of_a_motion_that_never_arrives_is_sent_after_the_maximum_wait(simulation: Simulation):
    when, message = stroke_sent(simulation, Frozen())
    assert "easured" not in message
    assert 1.0 + MAX_ARRIVAL_WAIT - TICK_PERIOD <= when <= 1.0 + MAX_ARRIVAL_WAIT + 2 * TICK_PERIOD


@pytest.mark.parametrize(
    "changes",
    [
        {"moving": {}},
        {"moving": {("b", "h"): np.zeros(22, dtype=bool)}},
        {"moving": {("b", "other"): np.ones(22, dtype=bool)}},
        {"agenda": (ScheduledFeedback(1.0, Progress("b", None, "end", 0.0)),)},
        {"agenda": (ScheduledFeedback(1.0, "<written/>"),)},
    ],
)
def test_feedback_without_moving_hinges_does_not_wait_for_arrival(simulation: Simulation, changes: dict):
    when, message = stroke_sent(simulation, Frozen(), **changes)
    assert when < 1.0 + 2 * TICK_PERIOD
    assert "easured" not in message


def test_feedback_of_barely_moving_hinges_is_sent_at_planned_times(simulation: Simulation):
    """Their arrival cannot be measured, and feedback does not wait for it."""
    late = replace(ScheduledFeedback(1.0, STROKE), time=3.0)
    simulation.make([RealTimeSink(Body(0.03))])
    planner = simulation.link()
    every = np.ones(len(simulation.setup.robot.drives), dtype=bool)

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1, moving={("b", "h"): every}, agenda=(late,)))
        yield 4.0

    simulation.run(script())
    ((when, message, _),) = simulation.told
    assert "easured" not in message
    assert when < 3.0 + 2 * TICK_PERIOD


def test_bml_feedback_that_waits_for_the_robot_delays_later_messages_and_survives_replanning(simulation: Simulation):
    simulation.make([RealTimeSink(Frozen())])
    planner = simulation.link()
    every = np.ones(len(simulation.setup.robot.drives), dtype=bool)
    moving = {("b", "h"): every}
    due = ScheduledFeedback(1.0, STROKE), ScheduledFeedback(1.02, "<behind/>")

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1, moving=moving))
        yield 1.025
        planner.send(proposal(now=1.025, moving=moving, final=due))
        yield 1.05
        planner.send(proposal(now=1.05, moving=moving))
        yield 1.07
        planner.send(proposal(now=1.07, moving=moving, agenda=(ScheduledFeedback(1.2, "<later/>"),)))
        yield 2.0

    simulation.run(script())
    first, *others = sent(simulation)
    assert 'id="b:h:stroke"' in first
    assert others == ["<behind/>", "<later/>"]
