"""The live loop: stops and resuming faster than its tick, feedback that waits for the body, contention for a hand."""

import re
from multiprocessing import Pipe

import numpy as np
import pytest

from kinesic.controller.perform import set_up
from kinesic.realizer.feedback import Progress, ScheduledFeedback
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, Proposal
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import Effects

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0" end="0.5"/>'
STOPS = 250
BEAT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="1"/>'


def heard(client, wanted):
    """Messages up to one that has some text in it; each comes in time."""
    messages = [client.receive(20)]
    while messages[-1] is not None and wanted not in messages[-1]:
        messages.append(client.receive(20))
    assert messages[-1] is not None, f"{wanted} never came"
    return messages


def test_who_resumes_at_once_is_heard(server, becomes):
    loop = server.open.clients.session.loop
    with server.client() as client:
        for k in range(3):
            client.send(BLOCK.format(f"cut{k}", BEAT))
            heard(client, f'id="cut{k}:start"')
            client.stop()
            client.do("resume")
            client.send(BLOCK.format(f"next{k}", NOD))
            heard(client, f'id="next{k}:end"')
        assert becomes(lambda: loop.settled() and not loop.halted)


def test_servos_that_want_consent_refuse_blocks_until_somebody_resumes(server):
    server.witness.held = True
    with server.client() as client:
        client.send(BLOCK.format("early", NOD))
        assert "the servos were out of hand for more than a second, and hold" in heard(client, "early")[-1]
        client.do("status")
        assert '"state":"stopped"' in heard(client, "told")[-1]
        client.do("resume")
        client.send(BLOCK.format("again", NOD))
        heard(client, 'id="again:end"')
    assert not server.witness.held


def test_another_stop_right_after_resuming_holds(server, becomes):
    loop = server.open.clients.session.loop
    with server.client() as client:
        client.send(BLOCK.format("cut", BEAT))
        heard(client, 'id="cut:start"')
        for verb in ("stop", "resume", "stop"):
            client.do(verb)
        client.send(BLOCK.format("refused", NOD))
        assert 'id="refused" type="IMPOSSIBLE_TO_SCHEDULE">rule stopped' in heard(client, "refused")[-1]
        assert becomes(lambda: loop.halted and loop.settled())
        still = len(server.witness.commands)
        assert becomes(lambda: len(server.witness.commands) > still + 50)
        held = np.array([command.angles for _, command in server.witness.commands[still:]])
        assert np.ptp(held, axis=0).max() < 1e-9
        client.do("resume")
        client.send(BLOCK.format("after", NOD))
        heard(client, 'id="after:end"')


class Blind:
    """A body that never tells where it is."""

    def write(self, command, /):
        pass

    def close(self):
        pass

    def seen(self):
        return None


def test_what_waits_for_the_body_outlives_the_next_proposal(known, becomes):
    """What one proposal says for good is in no later one, and its turn may come after that one."""
    clock, told, (ours, planners) = Clock(), [], Pipe()
    loop = Loop(
        known,
        [RealTimeSink(Blind())],
        clock,
        effects=Effects(),
        tell=lambda message, sender: told.append(message),
        news=lambda message: None,
    )
    moving = {("b", "h"): np.ones(len(known.robot.drives), dtype=bool)}

    def propose(*agenda, said=()):
        now = clock.now()
        planners.send(Proposal(0, now, now, None, said, agenda, frozenset(), moving, {}))
        return planners.recv()

    loop.link(ours, loop.beginning())
    loop.start()
    try:
        due = clock.now()
        point = ScheduledFeedback(due, Progress("b", "h", "stroke", 0.0))
        assert propose(said=(point, ScheduledFeedback(due, "<behind/>"))).accepted
        later = ScheduledFeedback(clock.now() + 0.01, "<later/>")
        assert propose(later).accepted
        assert propose(later).accepted
        assert becomes(lambda: len(told) == 3)
    finally:
        loop.leave()
        loop.join()
    assert told[1:] == ["<behind/>", "<later/>"]
    assert 'id="b:h:stroke"' in told[0]


def passed(messages, point):
    """When a point of a block was passed [s]; None as long as it was not."""
    found = (re.search(rf'Progress [^>]*id="{point}" [^>]*globalTime="([^"]*)"', each) for each in messages)
    return next((float(match[1]) for match in found if match), None)


def test_a_gesture_takes_the_hand_that_another_block_leaves_free(server, becomes):
    assert becomes(server.open.clients.session.loop.settled)
    with server.client() as working, server.client() as other:
        working.send(BLOCK.format("holds", '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0" relax="4"/>'))
        messages = heard(working, 'id="holds:start"')
        answers = list(other.perform(BLOCK.format("beside", '<gesture id="g" lexeme="BEAT" start="0"/>')))
        messages += heard(working, 'id="holds:end"')
    (warning,) = (each for each in answers if "warningFeedback" in each)
    assert "moved to the left hand" in warning
    assert "the right hand is busy with holds:g" in warning
    assert passed(answers, "beside:end") < passed(messages, "holds:g:relax")
    robot, at = set_up().robot, passed(answers, "beside:g:stroke")
    pose = min((command for _, command in server.witness.commands), key=lambda each: abs(each.time - at)).angles
    assert np.abs((pose - robot.skeleton.rest)[list(robot.joints("l_arm"))]).max() > np.radians(10.0)


def test_a_planner_that_reads_nothing_does_not_hold_up_the_loop_however_many_stops_come(becomes):
    setup, clock = set_up(), Clock()
    ours, planner = Pipe()
    loop = Loop(setup, [], clock, effects=Effects(), tell=lambda message, sender: None, news=lambda news: None)
    loop.link(ours, loop.beginning())
    loop.start()
    try:
        for _ in range(STOPS):
            before = loop._out
            loop.halt()
            assert becomes(lambda before=before: loop._out > before), "it ticks no longer"
        told = 0
        while told < STOPS and planner.poll(1.0):
            told = planner.recv().stops
        assert told == STOPS  # the last one is told in any case
    finally:
        loop.leave()
        planner.close()
        loop.join(10.0)
    assert not loop.is_alive()
