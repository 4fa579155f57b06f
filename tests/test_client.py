"""Client and example programs with a real server and real message brokers."""

import json
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import Queue
from textwrap import dedent
from threading import Thread
from urllib.parse import quote_plus

import pytest
import stomp

import kinesic.client
from kinesic.bench.bml.server import Server, open_server
from kinesic.client import Client

from .growth import LINEAR_GROWTH_LIMIT, growth

pytestmark = pytest.mark.realtime

EXAMPLES = Path(__file__).parent.parent / "examples"
BML = "http://www.bml-initiative.org/bml/bml-1.0"
NOD = '<head id="h" lexeme="NOD" start="0"/>'
MAX_WAIT = 30.0  # [s] longest wait for a message or program


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with open_server() as result:
        yield result


def test_example_in_the_docstring_of_the_client_module_runs(server, capsys, monkeypatch):
    code = dedent(re.search(r"```python\n(.*?)```", kinesic.client.__doc__, re.DOTALL)[1])
    monkeypatch.setattr(kinesic.client.Client.__init__, "__defaults__", ("127.0.0.1", server.port))
    exec(compile(code, "docstring", "exec"), {})
    assert 'id="b1:end"' in capsys.readouterr().out


def test_client_without_a_server_raises_connection_refused_error(server):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        with pytest.raises(ConnectionRefusedError):
            Client(port=free.getsockname()[1])


def test_client_receive_returns_none_after_its_timeout(server):
    with Client(port=server.port) as client:
        assert client.receive(0.0) is None
        assert client.receive(0.05) is None


def test_client_finds_a_block_id_behind_many_tags_in_linear_time():
    def perform(text: str) -> None:
        with (
            socket.create_server(("127.0.0.1", 0)) as listening,
            Client(port=listening.getsockname()[1]) as client,
            listening.accept()[0] as served,
        ):
            served.sendall(f'<blockProgress xmlns="{BML}" id="block:end"/>\0'.encode())
            list(client.perform(text))

    assert growth(perform, lambda size: size * "<bml ", most=2**14) < LINEAR_GROWTH_LIMIT


def test_refused_block_ends_a_client_perform_call(server):
    with Client(port=server.port) as client:
        results = list(client.perform('<bml id="bad"><head id="h" start="h:end+nonsense:1:2:3:4"/></bml'))
    assert "PARSING_FAILURE" in results[-1]


def test_block_refused_by_a_stopped_server_ends_the_perform_call_of_the_client(server):
    with Client(port=server.port) as client:
        client.stop()
        results = list(client.perform('<bml id="late"><head id="h" lexeme="NOD" start="0"/></bml>'))
        client.do("resume")
    assert 'id="late"' in results[-1]
    assert "rule stopped" in results[-1]


def test_client_sends_stop_resume_and_ping_messages(server):
    with Client(port=server.port) as client:
        client.stop()
        assert json.loads(client.receive(MAX_WAIT)) == {"told": "stopped"}
        client.do("resume")
        client.do("ping", id="x")
        assert json.loads(client.receive(MAX_WAIT)) == {"told": "pong", "id": "x"}


def test_client_example_program_performs_blocks_and_prints_feedback(server):
    done = subprocess.run(
        [sys.executable, EXAMPLES / "06_live.py", str(server.port)], capture_output=True, text=True, check=True
    )
    assert "second:end" in done.stdout
    assert '"told":"status"' in done.stdout


STORY_TEXT = "Once there was a fish. It was huge!"
RECORDED_ANSWERS = (  # recorded answers of a model; the first one lacks a comma
    """Here it is: {"id": "story1", "behaviours": [
    {"type": "speech", "id": "s", "text": ["Once there was a fish. It was ", {"sync": "m1"}, "huge!"]}
    {"type": "gesture", "id": "g1", "lexeme": "large", "stroke": "s:m1"}]}""",
    """{"id": "story2", "behaviours": [
    {"type": "speech", "id": "s", "text": ["Once there was a fish. It was ", {"sync": "m1"}, "huge!"]},
    {"type": "gesture", "id": "g1", "lexeme": "large", "stroke": "s:m1"}]}""",
)


@contextmanager
def recorded_model(asked: list[dict]) -> Iterator[str]:
    """Serve a chat API with recorded answers and record its requests."""

    class Recorded(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            assert self.path == "/v1/chat/completions"
            asked.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            message = {"role": "assistant", "content": RECORDED_ANSWERS[len(asked) - 1]}
            body = json.dumps({"choices": [{"message": message}]}).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_arguments: object) -> None:
            """Log nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Recorded) as model:
        Thread(target=model.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{model.server_port}/v1"
        model.shutdown()


def test_language_model_example_corrects_refused_documents(server, tmp_path):
    asked: list[dict] = []
    story = tmp_path / "story.txt"
    story.write_text(STORY_TEXT)
    with recorded_model(asked) as url:
        call = [sys.executable, EXAMPLES / "11_story.py", url, "recorded", story, str(server.port)]
        done = subprocess.run(call, capture_output=True, text=True, check=True)
    assert "story2:end" in done.stdout
    first, second = (item["messages"] for item in asked)
    assert STORY_TEXT in first[1]["content"]
    assert "PARSING_FAILURE" in second[-1]["content"]
    assert second[-2]["content"] == RECORDED_ANSWERS[0]


@contextmanager
def coilmq() -> Iterator[int]:
    program = Path(sys.executable).with_name("coilmq")
    if not program.exists():
        pytest.skip("coilmq is not installed")
    port = _free()
    with _process(program, "-p", str(port)):
        _await(port)
        yield port


@contextmanager
def activemq() -> Iterator[int]:
    jars = Path("/usr/share/java")
    if shutil.which("java") is None or not (jars / "activemq-run.jar").exists():
        pytest.skip("ActiveMQ is not installed")
    port = _free()
    places = "/usr/share/activemq/lib/*:/usr/share/java/*"
    broker = f"broker:(stomp://127.0.0.1:{port})?persistent=false&useJmx=false"
    with _process("java", "-cp", places, "org.apache.activemq.console.Main", "start", broker):
        _await(port)
        yield port


@pytest.fixture(scope="module", params=[coilmq, pytest.param(activemq, marks=pytest.mark.soak)])
def broker(request) -> Iterator[int]:
    with request.param() as port:
        yield port


@pytest.fixture(scope="module")
def toolkit(server, broker) -> Iterator[None]:
    with _example("08_smartbody_vhmsg.py", server.port, broker):
        yield


def test_greta_stomp_example_forwards_bml_and_feedback(server, broker):
    with _example("07_greta_stomp.py", server.port, broker):
        heard, link = _listening(broker, "/topic/greta.output.feedback.BML")
        link.send("/topic/greta.BML", f'<bml id="greta-{broker}">{NOD}</bml>')
        _until(heard, f'id="greta-{broker}:end"')
        link.disconnect()


@pytest.mark.parametrize("encoded", [False, True])
def test_smartbody_example_program_answers_a_request_with_start_and_end(toolkit, broker, encoded):
    name = f"sbm_test_{int(encoded)}_{broker}"
    xml = f'<?xml version="1.0" encoding="UTF-8"?>\n<act><bml>{NOD}</bml></act>'
    rest = f"ChrBrad ALL {name} {xml}"
    heard, link = _listening(broker, "/topic/DEFAULT_SCOPE")
    link.send("/topic/DEFAULT_SCOPE", f"vrSpeak {quote_plus(rest) if encoded else rest}")
    _until(heard, f"vrAgentBML ChrBrad ALL {name} start")
    _until(heard, f"vrAgentBML ChrBrad ALL {name} end complete")
    link.disconnect()


def _listening(port, topic):
    """Subscribe to a topic, and return its messages and the connection."""
    heard, link, listener = Queue(), stomp.Connection([("127.0.0.1", port)]), stomp.ConnectionListener()
    listener.on_message = lambda frame: heard.put(frame.body)
    link.set_listener("test", listener)
    link.connect(wait=True)
    link.subscribe(topic, id="test")
    return heard, link


def _until(heard, wanted):
    while wanted not in heard.get(timeout=MAX_WAIT):
        pass


@contextmanager
def _example(name: str, *ports: int) -> Iterator[None]:
    """Run an example program and wait until it is ready."""
    with _process(sys.executable, EXAMPLES / name, *map(str, ports)) as process:
        assert "performs" in process.stdout.readline()
        time.sleep(0.3)  # until the broker has registered the subscription
        yield


@contextmanager
def _process(*command: str | Path) -> Iterator[subprocess.Popen]:
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def _free() -> int:
    with socket.socket() as result:
        result.bind(("127.0.0.1", 0))
        return result.getsockname()[1]


def _await(port: int) -> None:
    end = time.monotonic() + MAX_WAIT
    while time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    pytest.fail("the broker does not start")
