"""Tools over HTTP: web pages, rebound names and missing tokens are refused."""

import asyncio
import http.client
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import AsyncExitStack
from importlib import import_module
from importlib.util import find_spec

import pytest

from kinesic.mcp.call_queue import CallQueue

from .tool_servers import http_client, text_of

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
]

HELLO = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}},
}
FEW_SESSIONS = 20  # number of sessions, more than `MAX_SESSIONS`
HEADERS = {"Content-Type": "application/json", "Accept": "application/json, text/event-stream"}


@pytest.fixture
def port(request: pytest.FixtureRequest) -> Iterator[int]:
    """Port of an open server, with the token as parameter."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
    uvicorn, mcp, web = map(import_module, ("uvicorn", "mcp.server", "kinesic.mcp.web"))  # only if this test runs alone
    tools = mcp.MCPServer("test")
    calls = CallQueue(interval=0.0)

    @tools.tool()
    async def hold(seconds: float) -> str:
        async def act() -> str:
            async with calls.turn():
                await asyncio.sleep(seconds)
            return "held"

        return await calls.run(act)

    app = web.web_app(tools, "127.0.0.1", number, token=request.param)
    server = uvicorn.Server(uvicorn.Config(app, host="127.0.0.1", port=number, log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        thread.join(0.02)
    yield number
    server.should_exit = True
    thread.join(20)


def answer(port: int, **more: str) -> int:
    """Return the HTTP status of a first message."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    headers = {**HEADERS, **{name.replace("_", "-"): value for name, value in more.items()}}
    connection.request("POST", "/mcp", json.dumps(HELLO), headers)
    status = connection.getresponse().status
    connection.close()
    return status


@pytest.mark.parametrize("port", [None], indirect=True)
def test_mcp_http_server_accepts_local_programs_and_refuses_foreign_web_pages(port: int):
    assert answer(port) == 200
    assert answer(port, Origin=f"http://127.0.0.1:{port}") == 200
    assert answer(port, Origin="https://evil.example") == 403
    assert answer(port, Origin="null") == 403
    assert answer(port, Host="rebound.example") in (403, 421)


@pytest.mark.parametrize("port", ["open sesame"], indirect=True)
def test_mcp_http_server_admits_a_client_with_the_token_and_refuses_others(port: int):
    assert answer(port, Authorization="Bearer open sesame") == 200
    assert answer(port) == 401
    assert answer(port, Authorization="Bearer wrong") == 401


@pytest.mark.parametrize("port", [None], indirect=True)
def test_forty_successive_http_clients_are_served_during_a_pending_tool_call(port: int):
    async def run() -> tuple[str, int]:
        url, counted = f"http://127.0.0.1:{port}/mcp", 0
        async with AsyncExitStack() as opened:
            first = await opened.enter_async_context(http_client(url))
            pending = asyncio.create_task(first.call_tool("hold", {"seconds": 3.0}))
            for _ in range(FEW_SESSIONS):
                counted += len((await (await opened.enter_async_context(http_client(url))).list_tools()).tools)
            counted += sum(answer(port) == 200 for _ in range(40 - FEW_SESSIONS))
            return text_of(await pending), counted

    assert asyncio.run(run()) == ("held", 40)


@pytest.mark.parametrize("port", [None], indirect=True)
@pytest.mark.parametrize("mode", ["legacy", "auto"])
def test_tool_call_of_a_disconnected_http_client_leaves_the_queue(port: int, mode: str):
    async def run() -> str:
        url = f"http://127.0.0.1:{port}/mcp"
        async with http_client(url, mode=mode) as leaving, http_client(url, mode=mode) as other:
            abandoned = asyncio.create_task(leaving.call_tool("hold", {"seconds": 600.0}))
            await asyncio.sleep(0.5)
            waiting = asyncio.create_task(other.call_tool("hold", {"seconds": 0.0}))
            await asyncio.sleep(0.2)
            abandoned.cancel()
            return text_of(await asyncio.wait_for(waiting, 20))

    assert asyncio.run(run()) == "held"


@pytest.mark.parametrize("port", [None], indirect=True)
def test_tool_call_whose_http_connection_breaks_leaves_the_queue(port: int):
    session = None
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("POST", "/mcp", json.dumps(HELLO), HEADERS)
    response = connection.getresponse()
    session = response.getheader("mcp-session-id")
    connection.close()
    call = {"jsonrpc": "2.0", "method": "tools/call", "params": {"name": "hold", "arguments": {"seconds": 600.0}}}
    broken = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    broken.request("POST", "/mcp", json.dumps(call | {"id": 2}), HEADERS | {"mcp-session-id": session})
    assert broken.getresponse().status == 200  # the stream has started

    async def run() -> str:
        async with http_client(f"http://127.0.0.1:{port}/mcp") as other:
            waiting = asyncio.create_task(other.call_tool("hold", {"seconds": 0.0}))
            await asyncio.sleep(0.3)
            assert not waiting.done()
            broken.close()
            return text_of(await asyncio.wait_for(waiting, 20))

    assert asyncio.run(run()) == "held"
