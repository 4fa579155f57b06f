"""Successive gaze shifts on a live server end like the last one alone."""

import random
import re
from time import sleep

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.plan import plan_block
from kinesic.session.setup import set_up

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
SHIFT = '<gazeShift id="l" target="1 {:.3f} {:.3f}"/>'
NOD = '<head id="n" lexeme="NOD"/>'
ANGLE_TOLERANCE = np.radians(1.0)
MAX_SILENCE = 4.0  # [s] without a message after which all blocks have ended

pytestmark = pytest.mark.realtime


def chain_error(server, count: int, seed: int) -> float:
    """Send random gaze shifts and nods; return the final trunk error [rad]."""
    chance, loop = random.Random(seed), server.open.clients.session.loop
    shifts: dict[str, str] = {}
    with server.client() as client:
        for number in range(count):
            id = f"chain{seed}.{number}"
            shifts[id] = SHIFT.format(chance.uniform(-1.5, 1.5), chance.uniform(0.0, 1.2))
            client.send(BLOCK.format(id, shifts[id] + (NOD if chance.random() < 0.2 else "")))
            sleep(chance.choice((chance.uniform(0.0, 0.3), chance.uniform(0.0, 1.2))))
        messages = []
        while (message := client.receive(MAX_SILENCE)) is not None:
            messages.append(message)
    ended = [id for message in messages for id in re.findall(r'<blockProgress [^>]*?\bid="([^":]*):end"', message)]
    left_out = {id for message in messages for id in re.findall(r'id="([^":]*):l"[^>]*>left out', message)}
    performed = [id for id in shifts if id in ended and id not in left_out]
    assert len(performed) > count // 3
    setup = set_up()
    hinges = [*setup.robot.joints("torso"), *setup.robot.joints("neck")]
    alone = plan_block(parse(BLOCK.format("b", shifts[performed[-1]])), setup).trajectory.controls[-1]
    return float(np.abs(loop.motion.controls[-1] - alone)[hinges].max())


def test_final_posture_after_eight_gaze_shifts_on_a_server_equals_that_of_the_last_shift_alone(server):
    assert chain_error(server, 8, seed=1) < ANGLE_TOLERANCE


@pytest.mark.soak
@pytest.mark.parametrize("seed", [2, 3])
def test_final_posture_after_200_gaze_shifts_on_a_server_equals_that_of_the_last_shift_alone(server, seed):
    assert chain_error(server, 200, seed) < ANGLE_TOLERANCE


@pytest.mark.soak
def test_gaze_shift_before_an_emergency_stop_does_not_affect_later_gaze_shifts(server, becomes):
    session = server.open.clients.session
    with server.client() as client:
        client.send(BLOCK.format("before", SHIFT.format(0.9, 0.6)))
        while client.receive(MAX_SILENCE) is not None:
            pass
        client.do("stop")
        assert becomes(lambda: session.loop.is_stopped)
        client.do("resume")
        assert becomes(lambda: not session.loop.is_stopped)
    assert chain_error(server, 2, seed=4) < ANGLE_TOLERANCE
