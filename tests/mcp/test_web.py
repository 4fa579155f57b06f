"""The tools by HTTP: no page of the web, no rebound name and nobody without the token calls them."""

import http.client
import json
import socket
import threading
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec

import pytest

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
HEADERS = {"Content-Type": "application/json", "Accept": "application/json, text/event-stream"}


@pytest.fixture
def port(request: pytest.FixtureRequest) -> Iterator[int]:
    """Of an open server; the parameter is its token."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
    uvicorn, mcp, web = map(import_module, ("uvicorn", "mcp.server", "kinesic.mcp.web"))  # by whoever runs this alone
    app = web.web_app(mcp.MCPServer("test"), "127.0.0.1", number, token=request.param)
    server = uvicorn.Server(uvicorn.Config(app, host="127.0.0.1", port=number, log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        thread.join(0.02)
    yield number
    server.should_exit = True
    thread.join(20)


def answer(port: int, **more: str) -> int:
    """The status by which a first message is answered."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    headers = {**HEADERS, **{name.replace("_", "-"): value for name, value in more.items()}}
    connection.request("POST", "/mcp", json.dumps(HELLO), headers)
    status = connection.getresponse().status
    connection.close()
    return status


@pytest.mark.parametrize("port", [None], indirect=True)
def test_programs_of_this_machine_come_in_and_pages_of_the_web_do_not(port: int):
    assert answer(port) == 200
    assert answer(port, Origin=f"http://127.0.0.1:{port}") == 200
    assert answer(port, Origin="https://evil.example") == 403
    assert answer(port, Origin="null") == 403
    assert answer(port, Host="rebound.example") in (403, 421)


@pytest.mark.parametrize("port", ["open sesame"], indirect=True)
def test_whoever_shows_the_token_comes_in(port: int):
    assert answer(port, Authorization="Bearer open sesame") == 200
    assert answer(port) == 401
    assert answer(port, Authorization="Bearer wrong") == 401
