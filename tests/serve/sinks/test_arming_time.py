"""Torque for servos in simulated time: who may confirm, how long, and what ends waiting."""

import asyncio
from collections.abc import Callable, Coroutine

import pytest

from kinesic.serve.sinks import arming
from kinesic.serve.sinks.arming import FOLDING, LASTS, LETTERS
from kinesic.serve.wire.protocol import Arm, Disarm

from .arming_desk import Client, Desk, Play, Servos


@pytest.fixture
def play(monkeypatch: pytest.MonkeyPatch) -> Play:
    def run(scene: Callable[[Desk, Servos], Coroutine]) -> None:
        servos = Servos()
        asyncio.run(scene(Desk(monkeypatch, servos), servos))

    return run


def test_a_confirmation_in_time_gives_torque(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        asked = await desk.ask(client)
        assert (asked["told"], asked["id"], asked["servos"], asked["lasts"]) == ("confirm", 5, 3, LASTS)
        assert len(asked["code"]) == 2 * LETTERS
        assert desk.loop.asked == 0
        desk.time += LASTS - 0.1
        assert await desk.ask(client, asked["code"]) == {"told": "armed", "id": 5}
        assert servos.armed
        assert desk.loop.asked == 1
        assert servos.done == []

    play(scene)


@pytest.mark.parametrize("late", [0.0, 0.1, 100.0])
def test_a_confirmation_lapses(play: Play, late: float):
    """Whoever went away to look whether nobody is in the way, and forgot, gives no torque by a click much later."""

    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.time += LASTS + late
        answer = await desk.ask(client, code)
        assert answer["told"] == "refused"
        assert f"not confirmed within {LASTS:.0f} s" in answer["why"]
        assert not servos.armed
        assert desk.loop.asked == 0

    play(scene)


def test_half_a_minute_is_what_a_person_has():
    assert LASTS == 30.0


def test_another_client_s_request_prolongs_no_confirmation(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        desk.time += LASTS / 2
        others = (await desk.ask(other))["code"]
        assert others != code
        desk.time += LASTS / 2 + 1.0
        assert (await desk.ask(one, code))["told"] == "refused"
        assert (await desk.ask(other, others))["told"] == "armed"

    play(scene)


def test_a_code_counts_once_for_the_client_that_was_told_it(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        assert (await desk.ask(other, code))["told"] == "refused"
        assert (await desk.ask(one, "wrong"))["told"] == "refused"
        assert (await desk.ask(one, code))["told"] == "refused", "a wrong guess voids it"
        assert not servos.armed

    play(scene)


def test_every_code_is_another(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        codes = {(await desk.ask(Client(number)))["code"] for number in range(20)}
        assert len(codes) == 20

    play(scene)


def test_a_message_without_the_token_gives_no_torque_and_voids_the_code(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        assert "token" in (await desk.ask(client, trusted=False))["why"]
        code = (await desk.ask(client))["code"]
        assert "token" in (await desk.ask(client, code, trusted=False))["why"]
        assert (await desk.ask(client, code))["told"] == "refused"
        assert not servos.armed

    play(scene)


def test_a_hindrance_is_told_and_refuses_even_what_is_confirmed(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.control.hindrance = "the motion goes on"
        assert (await desk.ask(client, code))["why"] == "the motion goes on"
        assert (await desk.ask(client))["why"] == "the motion goes on"
        assert not servos.armed
        servos.armed = True
        assert (await desk.ask(client))["why"] == "the servos have their torque already"

    play(scene)


def test_servos_that_nobody_drives_are_opened_first(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.state, client = "ended", Client()
        code = (await desk.ask(client))["code"]
        assert servos.done == []
        assert (await desk.ask(client, code))["told"] == "armed"
        assert servos.done == ["revived"]

    play(scene)


def test_nobody_waits_for_a_loop_that_has_ended(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        client = Client()
        code = (await desk.ask(client))["code"]
        desk.loop.alive, desk.loop.ticks = False, 10**9
        async with asyncio.timeout(5.0):
            await desk.ask(client, code)
        assert desk.time < 1001.0

    play(scene)


def test_two_changes_of_torque_do_not_meet(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        one, other = Client(1), Client(2)
        code = (await desk.ask(one))["code"]
        desk.arming.arm(one, Arm(token=None, code=code, id=5), trusted=True)
        desk.arming.disarm(other, Disarm(id=6))
        desk.arming.arm(other, Arm(token=None, code=None, id=7), trusted=True)
        assert [each["why"] for each in other.told] == [arming.BUSY] * 2
        assert [each["id"] for each in other.told] == [6, 7]
        assert desk.control.interrupted == []
        await desk.finish()
        assert one.last["told"] == "armed"
        assert (await desk.disarm(other))["told"] == "disarmed"

    play(scene)


def test_torque_is_taken_when_all_blocks_have_ended(play: Play):
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


def test_blocks_that_do_not_end_are_not_waited_for_without_end(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, desk.loop.rests = True, False
        assert (await desk.disarm(Client()))["told"] == "disarmed"
        assert desk.time == pytest.approx(1000.0 + FOLDING, abs=0.1)

    play(scene)


def test_servos_of_a_loop_that_has_ended_lose_their_torque_at_once(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, desk.loop.rests, desk.loop.alive = True, False, False
        assert (await desk.disarm(Client()))["told"] == "disarmed"
        assert desk.time == 1000.0

    play(scene)


def test_a_failure_is_told_and_the_next_request_is_taken(play: Play):
    async def scene(desk: Desk, servos: Servos) -> None:
        servos.armed, servos.fault, client = True, "a limb is held", Client()
        assert await desk.disarm(client) == {"told": "refused", "id": 6, "why": "a limb is held"}
        servos.fault = ""
        assert (await desk.disarm(client))["told"] == "disarmed"

    play(scene)


def test_what_is_under_way_ends_with_the_server(play: Play):
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


def test_a_server_without_servos_says_so(monkeypatch: pytest.MonkeyPatch):
    async def scene() -> None:
        desk, client = Desk(monkeypatch, None), Client()
        assert "--on servos" in (await desk.ask(client))["why"]
        assert "--on servos" in (await desk.disarm(client))["why"]
        assert desk.control.interrupted == []

    asyncio.run(scene())
