"""Arming in simulated time: confirmation, expiry and timeouts."""

import asyncio
from collections.abc import Callable, Coroutine

import pytest

from kinesic.serve.sinks import arming
from kinesic.serve.sinks.arming import BLOCK_END_TIMEOUT, CODE_SIZE, CONFIRMATION_TIMEOUT
from kinesic.serve.wire.protocol import Arm, Disarm

from .arming_desk import Client, Desk, Play, Servos


@pytest.fixture
def play(monkeypatch: pytest.MonkeyPatch) -> Play:
    def run(scene: Callable[[Desk, Servos], Coroutine]) -> None:
        servos = Servos()
        asyncio.run(scene(Desk(monkeypatch, servos), servos))

    return run


def test_arming_confirmation_in_time_enables_the_torque(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        asked = await desk.ask(client)
        assert (asked["told"], asked["id"], asked["servos"], asked["lasts"]) == ("confirm", 5, 3, CONFIRMATION_TIMEOUT)
        assert len(asked["code"]) == 2 * CODE_SIZE
        assert desk.loop.asked == 0
        desk.time += CONFIRMATION_TIMEOUT - 0.1
        assert await desk.ask(client, asked["code"]) == {"told": "armed", "id": 5}
        assert servos.armed
        assert desk.loop.asked == 1
        assert servos.done == []

    play(scene)


@pytest.mark.parametrize("late", [0.0, 0.1, 100.0])
def test_arming_confirmation_expires(play: Play, late: float):
    """A confirmation that comes after the time limit does not arm the servos."""

    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.time += CONFIRMATION_TIMEOUT + late
        answer = await desk.ask(client, code)
        assert answer["told"] == "refused"
        assert f"not confirmed within {CONFIRMATION_TIMEOUT:.0f} s" in answer["why"]
        assert not servos.armed
        assert desk.loop.asked == 0

    play(scene)


def test_confirmation_timeout_for_arming_is_half_a_minute():
    assert CONFIRMATION_TIMEOUT == 30.0


def test_request_of_another_client_does_not_extend_the_confirmation_time_for_arming(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        desk.time += CONFIRMATION_TIMEOUT / 2
        others = (await desk.ask(other))["code"]
        assert others != code
        desk.time += CONFIRMATION_TIMEOUT / 2 + 1.0
        assert (await desk.ask(one, code))["told"] == "refused"
        assert (await desk.ask(other, others))["told"] == "armed"

    play(scene)


def test_confirmation_code_is_void_for_another_client_and_after_a_wrong_guess(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        assert (await desk.ask(other, code))["told"] == "refused"
        assert (await desk.ask(one, "wrong"))["told"] == "refused"
        assert (await desk.ask(one, code))["told"] == "refused", "a wrong guess voids it"
        assert not servos.armed

    play(scene)


def test_confirmation_codes_for_arming_are_unique(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        codes = {(await desk.ask(Client(number)))["code"] for number in range(20)}
        assert len(codes) == 20

    play(scene)


def test_arming_message_without_token_is_refused_and_invalidates_the_code(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        assert "token" in (await desk.ask(client, trusted=False))["why"]
        code = (await desk.ask(client))["code"]
        assert "token" in (await desk.ask(client, code, trusted=False))["why"]
        assert (await desk.ask(client, code))["told"] == "refused"
        assert not servos.armed

    play(scene)


def test_confirmed_arming_request_is_refused_while_a_reason_against_arming_exists(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.control.arming_obstacle = "the robot moves"
        assert (await desk.ask(client, code))["why"] == "the robot moves"
        assert (await desk.ask(client))["why"] == "the robot moves"
        assert not servos.armed
        servos.armed = True
        assert (await desk.ask(client))["why"] == "the servos are armed already"

    play(scene)


def test_servos_without_supervisor_are_reopened_before_arming(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.state, client = "ended", Client()
        code = (await desk.ask(client))["code"]
        assert servos.done == []
        assert (await desk.ask(client, code))["told"] == "armed"
        assert servos.done == ["revived"]

    play(scene)


def test_arming_does_not_wait_if_the_control_loop_has_ended(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.loop.alive, desk.loop.ticks = False, 10**9
        async with asyncio.timeout(5.0):
            await desk.ask(client, code)
        assert desk.time < 1001.0

    play(scene)


def test_torque_change_during_another_torque_change_is_refused(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        desk.arming.arm(one, Arm(token=None, code=code, id=5), trusted=True)
        desk.arming.disarm(other, Disarm(id=6))
        desk.arming.arm(other, Arm(token=None, code=None, id=7), trusted=True)
        assert [item["why"] for item in other.told] == [arming.BUSY_REFUSAL] * 2
        assert [item["id"] for item in other.told] == [6, 7]
        assert desk.control.interrupted == []
        await desk.finish()
        assert one.last["told"] == "armed"
        assert (await desk.disarm(other))["told"] == "disarmed"

    play(scene)


def test_torque_is_disabled_after_all_blocks_ended(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, desk.loop.rests, client = True, False, Client()
        desk.arming.disarm(client, Disarm(id=6))
        assert desk.control.interrupted == [None]
        for _ in range(20):
            await asyncio.sleep(0)
        assert servos.done == []
        assert not client.told
        desk.loop.rests = True
        await desk.finish()
        assert client.last == {"told": "disarmed", "id": 6}
        assert servos.done == ["disarmed"]

    play(scene)


def test_disarming_waits_for_blocks_only_up_to_a_timeout(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, desk.loop.rests = True, False
        assert (await desk.disarm(Client()))["told"] == "disarmed"
        assert desk.time == pytest.approx(1000.0 + BLOCK_END_TIMEOUT, abs=0.1)

    play(scene)


def test_servos_are_disarmed_immediately_if_the_control_loop_has_ended(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, desk.loop.rests, desk.loop.alive = True, False, False
        assert (await desk.disarm(Client()))["told"] == "disarmed"
        assert desk.time == 1000.0

    play(scene)


def test_disarming_failure_is_reported_and_the_next_request_accepted(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, servos.fault, client = True, "a limb is held", Client()
        assert await desk.disarm(client) == {"told": "refused", "id": 6, "why": "a limb is held"}
        servos.fault = ""
        assert (await desk.disarm(client))["told"] == "disarmed"

    play(scene)


def test_pending_disarm_request_is_cancelled_when_the_server_closes(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        desk.arming.close()
        servos.armed, desk.loop.rests, client = True, False, Client()
        desk.arming.disarm(client, Disarm(id=6))
        await asyncio.sleep(0)
        desk.arming.close()
        await desk.finish()
        assert servos.done == []
        assert not client.told

    play(scene)


def test_arming_without_servos_is_refused(monkeypatch: pytest.MonkeyPatch):
    async def scene() -> None:
        desk, client = Desk(monkeypatch, None), Client()
        assert "--on servos" in (await desk.ask(client))["why"]
        assert "--on servos" in (await desk.disarm(client))["why"]
        assert desk.control.interrupted == []

    asyncio.run(scene())
