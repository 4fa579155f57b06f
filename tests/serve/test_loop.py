"""Control loop in real time: stops, resumes and delayed feedback."""

import re
from multiprocessing import Pipe

import numpy as np
import pytest

from kinesic.realizer.feedback import Progress, ScheduledFeedback
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, Proposal
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import TrackEffects
from kinesic.session.setup import set_up

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0" end="0.5"/>'
STOP_COUNT = 250
BEAT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="1"/>'


def heard(client, wanted):
    """Return messages up to one that contains a text, within a time limit."""
    messages = [client.receive(20)]
    while messages[-1] is not None and wanted not in messages[-1]:
        messages.append(client.receive(20))
    assert messages[-1] is not None, f"{wanted} never came"
    return messages


def test_resume_directly_after_an_emergency_stop_is_obeyed(server, becomes):
    loop = server.open.clients.session.loop
    with server.client() as client:
        for k in range(3):
            client.send(BLOCK.format(f"cut{k}", BEAT))
            heard(client, f'id="cut{k}:start"')
            client.stop()
            client.do("resume")
            client.send(BLOCK.format(f"next{k}", NOD))
            heard(client, f'id="next{k}:end"')
        assert becomes(lambda: loop.is_settled() and not loop.is_stopped)


def test_held_servos_refuse_blocks_until_resume(server):
    server.witness.held = True
    with server.client() as client:
        client.send(BLOCK.format("early", NOD))
        assert "the servos hold after an interruption of more than a second" in heard(client, "early")[-1]
        client.do("status")
        assert '"state":"stopped"' in heard(client, "told")[-1]
        client.do("resume")
        client.send(BLOCK.format("again", NOD))
        heard(client, 'id="again:end"')
    assert not server.witness.held


def test_emergency_stop_directly_after_a_resume_holds_the_robot(server, becomes):
    loop = server.open.clients.session.loop
    with server.client() as client:
        client.send(BLOCK.format("cut", BEAT))
        heard(client, 'id="cut:start"')
        for verb in ("stop", "resume", "stop"):
            client.do(verb)
        client.send(BLOCK.format("refused", NOD))
        assert 'id="refused" type="IMPOSSIBLE_TO_SCHEDULE">rule stopped' in heard(client, "refused")[-1]
        assert becomes(lambda: loop.is_stopped and loop.is_settled())
        still = len(server.witness.commands)
        assert becomes(lambda: len(server.witness.commands) > still + 50)
        held = np.array([command.angles for _, command in server.witness.commands[still:]])
        assert np.ptp(held, axis=0).max() < 1e-9
        client.do("resume")
        client.send(BLOCK.format("after", NOD))
        heard(client, 'id="after:end"')


class Blind:
    """Stub sensor without any measurement."""

    def write(self, command, /):
        pass

    def close(self):
        pass

    def measurement(self):
        return None


def test_feedback_delayed_until_arrival_is_sent_once_after_the_next_proposal(known, becomes):
    """The next proposal must not repeat messages that wait for arrival."""
    clock, results, (ours, planners) = Clock(), [], Pipe()
    loop = Loop(
        known,
        [RealTimeSink(Blind())],
        clock,
        effects=TrackEffects(),
        send_feedback=lambda message, sender: results.append(message),
        notify_server=lambda message: None,
    )
    moving = {("b", "h"): np.ones(len(known.robot.drives), dtype=bool)}

    def propose(*agenda, final=()):
        now = clock.now()
        planners.send(Proposal(0, now, now, None, final, agenda, frozenset(), moving, {}))
        return planners.recv()

    loop.connect_planner(ours, loop.snapshot())
    loop.start()
    try:
        due = clock.now()
        point = ScheduledFeedback(due, Progress("b", "h", "stroke", 0.0))
        assert propose(final=(point, ScheduledFeedback(due, "<behind/>"))).accepted
        later = ScheduledFeedback(clock.now() + 0.01, "<later/>")
        assert propose(later).accepted
        assert propose(later).accepted
        assert becomes(lambda: len(results) == 3)
    finally:
        loop.shut_down()
        loop.join()
    assert results[1:] == ["<behind/>", "<later/>"]
    assert 'id="b:h:stroke"' in results[0]


def passed(messages, point):
    """Return when a point of a block was passed [s], or None."""
    results = (re.search(rf'Progress [^>]*id="{point}" [^>]*globalTime="([^"]*)"', message) for message in messages)
    return next((float(match[1]) for match in results if match), None)


def test_gesture_uses_the_hand_that_another_block_leaves_free(server, becomes):
    assert becomes(server.open.clients.session.loop.is_settled)
    with server.client() as working, server.client() as other:
        working.send(BLOCK.format("holds", '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0" relax="4"/>'))
        messages = heard(working, 'id="holds:start"')
        answers = list(other.perform(BLOCK.format("beside", '<gesture id="g" lexeme="BEAT" start="0"/>')))
        messages += heard(working, 'id="holds:end"')
    (warning,) = (answer for answer in answers if "warningFeedback" in answer)
    assert "moved to the left hand" in warning
    assert "the right hand is busy with holds:g" in warning
    assert passed(answers, "beside:end") < passed(messages, "holds:g:relax")
    robot, at = set_up().robot, passed(answers, "beside:g:stroke")
    pose = min((command for _, command in server.witness.commands), key=lambda each: abs(each.time - at)).angles
    assert np.abs((pose - robot.skeleton.rest)[list(robot.joints("l_arm"))]).max() > np.radians(10.0)


def test_blocked_planner_does_not_delay_the_loop_during_many_stops(becomes):
    setup, clock = set_up(), Clock()
    ours, planner = Pipe()
    loop = Loop(
        setup,
        [],
        clock,
        effects=TrackEffects(),
        send_feedback=lambda message, sender: None,
        notify_server=lambda news: None,
    )
    loop.connect_planner(ours, loop.snapshot())
    loop.start()
    try:
        for _ in range(STOP_COUNT):
            before = loop._commanded_until
            loop.emergency_stop()
            assert becomes(lambda before=before: loop._commanded_until > before), "it ticks no longer"
        result = 0
        while result < STOP_COUNT and planner.poll(1.0):
            result = planner.recv().stops
        assert result == STOP_COUNT  # the last stop is always reported
    finally:
        loop.shut_down()
        planner.close()
        loop.join(10.0)
    assert not loop.is_alive()
