"""Emergency stops and resuming that come faster than the loop ticks, at a real server."""

import numpy as np
import pytest

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0" end="0.5"/>'
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
        for k in range(6):
            client.send(BLOCK.format(f"cut{k}", BEAT))
            heard(client, f'id="cut{k}:start"')
            client.stop()
            client.do("resume")
            client.send(BLOCK.format(f"next{k}", NOD))
            heard(client, f'id="next{k}:end"')
        assert becomes(lambda: loop.settled() and not loop.halted)


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
