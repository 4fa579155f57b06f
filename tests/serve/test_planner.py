"""Two clients whose gestures want the same hand at a real server."""

import re

import numpy as np
import pytest

from kinesic.controller.perform import set_up

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
HOLDS = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0" relax="4"/>'
OPEN = '<gesture id="g" lexeme="BEAT" start="0"/>'


def told(messages, point):
    """When a point of a block was passed [s]; None as long as it was not."""
    found = (re.search(rf'Progress [^>]*id="{point}" [^>]*globalTime="([^"]*)"', each) for each in messages)
    return next((float(match[1]) for match in found if match), None)


def listened(client, messages, point):
    """Messages until a point was told."""
    while told(messages, point) is None:
        messages.append(client.receive(20))
    return messages


def test_a_gesture_takes_the_hand_that_another_block_leaves_free(server, becomes):
    assert becomes(server.open.clients.session.loop.settled)
    with server.client() as working, server.client() as other:
        working.send(BLOCK.format("holds", HOLDS))
        messages = listened(working, [], "holds:start")
        answers = list(other.perform(BLOCK.format("beside", OPEN)))
        listened(working, messages, "holds:end")
    (warning,) = (each for each in answers if "warningFeedback" in each)
    assert "moved to the left hand" in warning
    assert "the right hand is busy with holds:g" in warning
    assert told(answers, "beside:end") < told(messages, "holds:g:relax")
    robot, at = set_up().robot, told(answers, "beside:g:stroke")
    pose = min((command for _, command in server.witness.commands), key=lambda each: abs(each.time - at)).angles
    assert np.abs((pose - robot.skeleton.rest)[list(robot.joints("l_arm"))]).max() > np.radians(10.0)
