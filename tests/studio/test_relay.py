"""Relay to the robot of another server: token, stop line, origin and address checks."""

import asyncio
import json
from collections.abc import Awaitable, Callable, Iterator
from urllib.request import urlopen

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from kinesic.body.config import ConfigError
from kinesic.cli.live.attached import ask_robot, read_server, set_up_like
from kinesic.cli.options import Planning
from kinesic.serve.server import Address
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas
from kinesic.studio.relay import TRY_LATER_CODE, open_relay

from ..serve.conftest import Running, running

TOKEN, FILES = "open sesame", {"/": WebFile("text/html", b"<p>the page</p>")}
pytestmark = pytest.mark.realtime


@pytest.fixture(scope="module")
def robot() -> Iterator[Running]:
    with running(Quotas(), Access(TOKEN)) as result:
        yield result


def relayed(port: int, deed: Callable[[Address], Awaitable[None]]) -> None:
    """Run a test at the relay of a server."""

    async def act() -> None:
        async with open_relay(Address("127.0.0.1", 0), Address("127.0.0.1", port), FILES) as door:
            await asyncio.wait_for(deed(door), 20.0)

    asyncio.run(act())


async def ask(socket: ClientConnection, **message: object) -> dict:
    await socket.send(json.dumps(message))
    return json.loads(await socket.recv())


def test_studio_page_behind_a_relay_needs_the_token_of_the_robot_and_gets_a_stop_connection(robot: Running):
    async def act(door: Address) -> None:
        async with connect(f"ws://{door}/") as page:
            assert (await ask(page, do="status"))["told"] == "refused"
        async with connect(f"ws://{door}/") as page, connect(f"ws://{door}/") as stops:
            assert (await ask(page, do="hello", token=TOKEN))["told"] == "welcome"
            assert (await ask(page, do="status"))["robot"] == "upper22"
            await stops.send(json.dumps({"do": "hello", "token": TOKEN}))
            await stops.recv()
            assert (await ask(stops, do="stop_line"))["told"] == "stop_line"
            assert (await ask(stops, do="stop"))["told"] == "stopped"
            assert (await ask(page, do="status"))["state"] == "stopped"
            await page.send('{"do": "resume"}')

    relayed(robot.port, act)


def test_studio_relay_serves_the_page_and_rejects_other_origins(robot: Running):
    async def act(door: Address) -> None:
        shown = await asyncio.to_thread(lambda: urlopen(f"http://{door}/").read())
        assert shown == b"<p>the page</p>"
        for wrong in ({"origin": "http://evil.example"}, {"additional_headers": {"Host": "evil.example"}}):
            with pytest.raises(InvalidStatus):
                await connect(f"ws://{door}/", **wrong)
        async with connect(f"ws://{door}/", origin=f"http://{door}"):
            pass

    relayed(robot.port, act)


def test_studio_relay_closes_the_page_connection_with_a_reason_if_the_robot_is_unreachable():
    async def act(door: Address) -> None:
        async with connect(f"ws://{door}/") as page:
            with pytest.raises(ConnectionClosed) as closed:
                await page.recv()
        assert closed.value.rcvd.code == TRY_LATER_CODE
        assert "is not reachable" in closed.value.rcvd.reason

    relayed(1, act)


def test_studio_uses_the_robot_of_the_remote_server(robot: Running):
    here = Address("127.0.0.1", robot.port)
    assert ask_robot(here, TOKEN) == "upper22"
    for token in (None, "open barley"):
        with pytest.raises(ConfigError, match="--token"):
            ask_robot(here, token)
    with pytest.raises(ConfigError, match="is `kinesic serve` running there"):
        ask_robot(Address("127.0.0.1", 1), None)
    planning = Planning("upper22", "neutral", {})
    assert set_up_like(planning, "upper22", here).robot.name == "upper22"
    with pytest.raises(ConfigError, match="give its file with --robot"):
        set_up_like(planning, "golem", here)


@pytest.mark.parametrize(
    ("text", "host", "port"),
    [
        ("robot.local", "robot.local", 8864),
        ("10.0.0.7:99", "10.0.0.7", 99),
        ("[::1]:99", "::1", 99),
        ("::1", "::1", 8864),
    ],
)
def test_port_of_a_remote_server_address_is_optional(text: str, host: str, port: int):
    assert read_server(text) == Address(host, port)


@pytest.mark.parametrize("text", ["", ":99", "robot:x", "robot:0", "robot:70000"])
def test_invalid_remote_server_addresses_are_refused(text: str):
    with pytest.raises(ConfigError, match=r"give HOST or HOST:PORT"):
        read_server(text)
