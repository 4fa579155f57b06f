"""Connection of `kinesic mcp` to test doubles of the robot's server."""

import io
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.body.config import ConfigError
from kinesic.cli.live import mcp as verb
from kinesic.cli.options import Performers, Planning
from kinesic.expressivity.lexicon.categories import GESTURE_CATEGORIES
from kinesic.mcp.errors import RobotError
from kinesic.serve.address import Address

PLANNING = Planning("upper22", "calm", {})
TWIN = Performers(frozenset({"twin"}), ())
SERVOS = Performers(frozenset({"servos", "twin"}), ("left=/dev/a", "right=/dev/b"))


class Line:
    """Test double of the connection to a server."""

    def __init__(self, host: str, port: int, *, token: str | None) -> None:
        if port == 1:
            raise OSError("refused")
        self.address, self.token, self.is_open = (host, port), token, True

    def close(self) -> None:
        self.is_open = False


@pytest.fixture(autouse=True)
def no_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kinesic.mcp.robot_line.RobotLine", Line)


@pytest.mark.parametrize(
    ("text", "address"), [("127.0.0.1:88", ("127.0.0.1", 88)), ("[::1]:7", ("::1", 7)), ("::1:7", ("::1", 7))]
)
def test_address_of_a_running_server_is_parsed_into_host_and_port(text: str, address: tuple[str, int]) -> None:
    assert verb._read_server(text) == Address(*address)


@pytest.mark.parametrize("text", ["88", ":88", "host:", "host:8a", "host:-1"])
def test_server_address_without_a_host_or_a_valid_port_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match="give HOST:PORT"):
        verb._read_server(text)


def test_connection_to_a_running_server_is_closed_when_the_mcp_tools_end() -> None:
    with verb._open_robot("host:88", PLANNING, TWIN, "secret") as opened:
        line = opened.result(0)
        assert (line.address, line.token, line.is_open) == (("host", 88), "secret", True)
    assert not line.is_open


def test_connecting_to_a_server_that_does_not_run_raises_an_error_with_its_address() -> None:
    message = r"--connect host:1: refused; start kinesic serve there"
    with pytest.raises(ConfigError, match=message), verb._open_robot("host:1", PLANNING, TWIN, None):
        pass


class Server:
    """Test double of a server process that prints the given lines."""

    def __init__(self, lines: list[str]) -> None:
        self.lines, self.calls, self.stdin = lines, [], io.StringIO()
        self.stderr: Iterator[str] = iter(lines)
        self.hangs = False

    def start(self, command: list[str], **options: object) -> "Server":
        self.command, self.options = command, options
        return self

    def __enter__(self) -> "Server":
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.append("left")

    def wait(self, timeout: float) -> None:
        assert self.stdin.closed
        self.calls.append(("wait", timeout))
        if self.hangs:
            raise subprocess.TimeoutExpired("server", timeout)

    def kill(self) -> None:
        self.calls.append("kill")


def started(monkeypatch: pytest.MonkeyPatch, *lines: str) -> Server:
    server = Server([f"{line}\n" for line in lines])
    monkeypatch.setattr(verb.subprocess, "Popen", server.start)
    return server


@pytest.mark.parametrize(("token", "variable"), [("secret", "secret"), (None, "")])
def test_started_robot_server_gets_its_token_in_the_environment(monkeypatch, token, variable) -> None:
    monkeypatch.setenv("KEPT", "yes")
    server = started(monkeypatch, "starting", "listening at 127.0.0.1:88", "listening at 127.0.0.1:99")
    with verb._open_robot(None, PLANNING, TWIN, token) as opened:
        line = opened.result(5.0)
        assert (line.address, line.token) == (("127.0.0.1", 88), token)
    start = [sys.executable, "-m", "kinesic", "serve", "--listen", "127.0.0.1:0", "--end-with-input"]
    assert server.command == [*start, "--robot=upper22", "--style=calm", "--on=twin"]
    assert (server.options["env"]["KINESIC_TOKEN"], server.options["env"]["KEPT"]) == (variable, "yes")
    assert (server.options["stdin"], server.options["stderr"]) == (subprocess.PIPE, subprocess.PIPE)
    assert server.options["text"]
    assert not line.is_open


@pytest.mark.parametrize("hangs", [False, True])
def test_robot_server_gets_fifteen_seconds_to_end_before_it_is_killed(monkeypatch, hangs: bool) -> None:
    server = started(monkeypatch, "listening at 127.0.0.1:88")
    server.hangs = hangs
    with verb._open_robot(None, PLANNING, TWIN, None) as opened:
        opened.result(5.0)
    assert server.calls == [("wait", 15.0), "kill", "left"]


def test_mcp_tools_report_a_robot_server_that_did_not_start(monkeypatch) -> None:
    server = started(monkeypatch, "no robot")
    with verb._open_robot(None, PLANNING, TWIN, None) as opened:
        assert str(opened.exception(5.0)) == (
            "the server of the robot does not start: no robot. Nothing can move until kinesic mcp is started again"
        )
    assert server.calls == [("wait", 15.0), "kill", "left"]


def test_robot_server_that_refuses_the_connection_counts_as_not_started() -> None:
    opened: Future[object] = Future()
    verb._follow(Server(["listening at host:1", "listening at host:2"]), opened, None)
    with pytest.raises(RobotError, match="does not start: refused"):
        opened.result(0)


@pytest.mark.parametrize("line", ["listening at host:2", "no robot"])
def test_cancelled_robot_connection_stays_cancelled_if_the_server_starts_or_fails(line: str) -> None:
    opened: Future[object] = Future()
    assert opened.cancel()
    verb._follow(Server([line]), opened, None)
    assert opened.cancelled()


def test_robot_connection_that_opens_after_its_cancellation_is_closed(monkeypatch) -> None:
    opened: Future[object] = Future()
    lines: list[Line] = []

    def connect(host: str, port: int, *, token: str | None) -> Line:
        opened.cancel()
        lines.append(Line(host, port, token=token))
        return lines[-1]

    monkeypatch.setattr("kinesic.mcp.robot_line.RobotLine", connect)
    verb._follow(Server(["listening at host:2"]), opened, None)
    assert [line.is_open for line in lines] == [False]


def test_options_of_kinesic_mcp_are_passed_as_arguments_to_the_server_that_it_starts() -> None:
    options = {"settings": ("head.power=1", "overall.speed=2"), "lexicon": Path("mine.toml"), "seed": 0, "engine": None}
    assert verb._list_arguments(Planning("mine.toml", "calm", options), SERVOS) == [
        "--robot=mine.toml",
        "--style=calm",
        "--on=servos,twin",
        "--port=left=/dev/a",
        "--port=right=/dev/b",
        "--set=head.power=1",
        "--set=overall.speed=2",
        "--lexicon=mine.toml",
        "--seed=0",
    ]


def test_mcp_server_prints_configuration_errors_of_the_setup_and_no_other_errors(capsys) -> None:
    for error in (ConfigError("no style"), ValueError("bug"), None):
        setup: Future[object] = Future()
        setup.set_exception(error) if error else setup.set_result("setup")
        verb._report_invalid(setup)
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "kinesic: no style\n")


def test_mcp_server_loads_no_setup_if_the_robot_server_does_not_start(monkeypatch) -> None:
    opened: Future[object] = Future()
    opened.set_exception(RobotError("gone"))
    with pytest.raises(ConfigError, match="gone"):
        verb.load_setup(SimpleNamespace(set_up=lambda: pytest.fail("loaded")), opened)


class Tools:
    """Test double of the MCP server that only records its calls."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls: list[object] = []
        self.opened: Future[object] = Future()
        self.setup: object = "setup"

        @contextmanager
        def open_robot(*arguments: object) -> Iterator[Future[object]]:
            self.calls.append(("open", arguments))
            yield self.opened
            self.calls.append("closed")

        @contextmanager
        def raise_priority() -> Iterator[None]:
            self.calls.append("priority")
            yield

        self.opened.set_result("line")
        monkeypatch.setattr(verb, "_open_robot", open_robot)
        monkeypatch.setattr(verb, "raise_priority", raise_priority)
        monkeypatch.setattr(verb, "load_setup", self._load_setup)
        monkeypatch.setattr(verb, "ThreadPoolExecutor", lambda count, thread_name_prefix: self)
        monkeypatch.setattr(verb, "_load_lexicon", lambda planning: SimpleNamespace(categories=("own",)))
        monkeypatch.setattr(verb.sys, "setswitchinterval", self.calls.append)
        monkeypatch.setattr("kinesic.mcp.server.make_server", self._make)
        monkeypatch.setattr("kinesic.mcp.web.serve_web", lambda *places, token: self.calls.append((places, token)))

    def submit(self, load: Callable[..., object], *arguments: object) -> Future[object]:
        """Run a task of the thread pool in the calling thread."""
        done: Future[object] = Future()
        try:
            done.set_result(load(*arguments))
        except ConfigError as error:
            done.set_exception(error)
        return done

    def _load_setup(self, *arguments: object) -> object:
        assert arguments[1] is self.opened
        if isinstance(self.setup, Exception):
            raise self.setup
        return self.setup

    def _make(self, gate: object, load_lexicon: object, *, resumes: bool, categories: tuple[str, ...]) -> "Tools":
        self.resumes, self.categories, self.lexicon = resumes, categories, load_lexicon()
        return self

    def run(self, transport: str) -> None:
        self.calls.append(transport)


def test_mcp_tools_use_standard_streams_and_raise_the_process_priority(monkeypatch) -> None:
    tools = Tools(monkeypatch)
    assert verb.serve_tools(PLANNING, TWIN, None, "secret", None) == 0
    assert tools.calls == [("open", (None, PLANNING, TWIN, "secret")), "priority", 0.0001, "stdio", "closed"]
    assert (tools.resumes, tools.categories) == (True, GESTURE_CATEGORIES)


@pytest.mark.parametrize(("connect", "performers"), [("host:88", TWIN), (None, SERVOS)])
def test_mcp_tools_offer_no_resume_for_servos_or_a_remote_server(monkeypatch, connect, performers) -> None:
    tools = Tools(monkeypatch)
    verb.serve_tools(PLANNING, performers, connect, None, None)
    assert not tools.resumes


def test_mcp_tools_offer_the_gesture_categories_of_the_user_lexicon(monkeypatch) -> None:
    tools = Tools(monkeypatch)
    verb.serve_tools(Planning("upper22", "calm", {"lexicon": "mine.toml"}), TWIN, None, None, None)
    assert tools.categories == ("own",)
    assert tools.lexicon.categories == ("own",)


def test_mcp_tools_over_http_print_their_address_and_raise_setup_errors(monkeypatch, capsys) -> None:
    tools = Tools(monkeypatch)
    assert verb.serve_tools(PLANNING, TWIN, None, "secret", "127.0.0.1:88") == 0
    assert tools.calls[-2:] == [((tools, "127.0.0.1", 88), "secret"), "closed"]
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "tools at http://127.0.0.1:88/mcp\n")
    tools.setup = ConfigError("no style")
    with pytest.raises(ConfigError, match="no style"):
        verb.serve_tools(PLANNING, TWIN, None, None, "127.0.0.1:88")


def test_mcp_command_reports_an_invalid_setup_but_exits_with_code_0(monkeypatch, capsys) -> None:
    tools = Tools(monkeypatch)
    tools.setup = ConfigError("no style")
    assert verb.serve_tools(PLANNING, TWIN, None, None, None) == 0
    assert capsys.readouterr().err == "kinesic: no style\n"


def test_missing_mcp_package_raises_an_error_with_its_extra(monkeypatch) -> None:
    Tools(monkeypatch)

    def fail_to_import(name: str) -> None:
        raise ModuleNotFoundError(f"No module named {name}", name="mcp")

    monkeypatch.setattr(verb, "import_at_once", fail_to_import)
    with pytest.raises(ConfigError, match=r"kinesic mcp needs mcp: .*kinesic\[mcp\]"):
        verb.serve_tools(PLANNING, TWIN, None, None, None)


def test_mcp_tools_exit_with_2_if_the_robot_server_does_not_start(monkeypatch) -> None:
    tools = Tools(monkeypatch)
    tools.opened = Future()
    tools.opened.set_exception(RobotError("gone"))
    assert verb.serve_tools(PLANNING, TWIN, None, None, None) == 2
