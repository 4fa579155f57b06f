"""Gaze shifts sent one after the other to a live server, which end where the last one ends alone."""

import random
import re
from time import sleep

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.controller.perform import set_up
from kinesic.planning.plan import plan_block

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
SHIFT = '<gazeShift id="l" target="1 {:.3f} {:.3f}"/>'
NOD = '<head id="n" lexeme="NOD"/>'
TOLERANCE = np.radians(1.0)
QUIET = 4.0  # [s] without a message, after which all blocks are over

pytestmark = pytest.mark.realtime


def chain_error(server, count: int, seed: int) -> float:
    """Send random gaze shifts and nods, and measure how far [rad] the trunk ends from where the last shift ends."""
    chance, loop = random.Random(seed), server.open.clients.session.loop
    shifts: dict[str, str] = {}
    with server.client() as client:
        for number in range(count):
            id = f"chain{seed}.{number}"
            shifts[id] = SHIFT.format(chance.uniform(-1.5, 1.5), chance.uniform(0.0, 1.2))
            client.send(BLOCK.format(id, shifts[id] + (NOD if chance.random() < 0.2 else "")))
            sleep(chance.choice((chance.uniform(0.0, 0.3), chance.uniform(0.0, 1.2))))
        messages = []
        while (message := client.receive(QUIET)) is not None:
            messages.append(message)
    ended = [id for message in messages for id in re.findall(r'<blockProgress [^>]*?\bid="([^":]*):end"', message)]
    left_out = {id for message in messages for id in re.findall(r'id="([^":]*):l"[^>]*>left out', message)}
    performed = [id for id in shifts if id in ended and id not in left_out]
    assert len(performed) > count // 3
    setup = set_up()
    hinges = [*setup.robot.joints("torso"), *setup.robot.joints("neck")]
    alone = plan_block(parse(BLOCK.format("b", shifts[performed[-1]])), setup).trajectory.controls[-1]
    return float(np.abs(loop.motion.controls[-1] - alone)[hinges].max())


def test_live_chain_ends_where_the_last_gaze_shift_ends_alone(server):
    assert chain_error(server, 8, seed=1) < TOLERANCE


@pytest.mark.soak
@pytest.mark.parametrize("seed", [2, 3])
def test_live_chain_of_two_hundred_ends_where_the_last_gaze_shift_ends_alone(server, seed):
    assert chain_error(server, 200, seed) < TOLERANCE


def test_gaze_shift_after_an_emergency_stop_ends_where_it_ends_alone(server, becomes):
    session = server.open.clients.session
    with server.client() as client:
        client.send(BLOCK.format("before", SHIFT.format(0.9, 0.6)))
        while client.receive(QUIET) is not None:
            pass
        client.do("stop")
        assert becomes(lambda: session.loop.halted)
        client.do("resume")
        assert becomes(lambda: not session.loop.halted)
    assert chain_error(server, 2, seed=4) < TOLERANCE
