"""Files given to the live verbs, and messages of `say -`."""

import json
import sys
from concurrent.futures import Future
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import click
import pytest

from kinesic.body.config import ConfigError
from kinesic.cli.live import mcp as mcp_verb
from kinesic.cli.live import say
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.mcp import START_EXIT_CODE, _follow, _load_lexicon
from kinesic.cli.live.studio import _attach, _check_document
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.errors import RobotError


def test_lexicon_is_loaded_from_its_option_or_else_from_the_package(monkeypatch: pytest.MonkeyPatch):
    loaded: list[object] = []
    monkeypatch.setattr(Lexicon, "load", loaded.append)
    for options in ({}, {"lexicon": None}, {"lexicon": "mine.toml"}):
        _load_lexicon(SimpleNamespace(options=options))
    assert loaded == [None, None, Path("mine.toml")]


@pytest.mark.parametrize(
    ("name", "message"), [("a.txt", "name it NAME.bml"), ("con.bml", "name it NAME.bml"), ("b.bml", "no such file")]
)
def test_studio_refuses_documents_with_an_unusable_name_or_outside_its_folder(tmp_path: Path, name: str, message: str):
    (tmp_path / "a.bml").write_text("")
    _check_document(tmp_path / "a.bml", tmp_path)
    with pytest.raises(ConfigError, match=message):
        _check_document(tmp_path / name, tmp_path)
    with pytest.raises(ConfigError, match="is outside the folder"):
        _check_document(tmp_path / "a.bml", tmp_path.parent)


@pytest.mark.parametrize("as_json", [False, True])
def test_say_from_standard_input_prints_texts_or_json_and_refuses_a_report(
    monkeypatch: pytest.MonkeyPatch, as_json: bool
):
    opened: list[tuple] = []
    monkeypatch.setattr(say, "open_and_serve", lambda *arguments, console: opened.append((arguments, console)) or 0)
    monkeypatch.setattr(say, "FrozenPlanning", SimpleNamespace(of=lambda planning: "frozen"))
    assert say.speak_standard_input("planning", "performers", SimpleNamespace(out=None, as_json=as_json)) == 0
    ((arguments, console),) = opened
    assert arguments == ("frozen", say.NO_CLIENTS, "performers", None, ())
    assert console.keywords == {"show": click.echo if as_json else say._print_message}
    with pytest.raises(ConfigError, match="has no report"):
        say.speak_standard_input("planning", "performers", SimpleNamespace(out=Path("x"), as_json=as_json))


def test_say_prints_spoken_texts_to_output_and_problems_to_standard_error(capsys):
    for message in (
        json.dumps({"told": "saying", "text": "Hello"}),
        json.dumps({"told": "pong", "why": "late"}),
        "<warningFeedback id='a'>left out: a &amp; b</warningFeedback>",
        "<warningFeedback id='a'>slower</warningFeedback>",
    ):
        say._print_message(message)
    printed = capsys.readouterr()
    assert printed.out == "Hello\n"
    assert printed.err == "kinesic: late\nkinesic: left out: a & b\n"


def test_studio_with_a_remote_server_refuses_a_file_and_needs_a_page_address():
    access = AccessOptions("none", None, (), texts=False)
    with pytest.raises(ConfigError, match=r"mine\.bml: with --connect, documents are in the server's folder"):
        _attach(Path("mine.bml"), "planning", access, "127.0.0.1:9", print)
    with pytest.raises(ConfigError, match="a page needs an address"):
        _attach(None, "planning", access, "127.0.0.1:9", print)


@pytest.mark.parametrize(("fault", "code"), [(None, 0), (RobotError("gone"), START_EXIT_CODE)])
def test_mcp_tools_have_a_separate_exit_code_if_the_robot_did_not_start(
    monkeypatch: pytest.MonkeyPatch, fault: Exception | None, code: int
):
    pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")
    opened: Future[object] = Future()
    if fault is None:
        opened.set_result("line")
    else:
        opened.set_exception(fault)
    interval = sys.getswitchinterval()
    monkeypatch.setattr(mcp_verb, "_open_robot", lambda *_: nullcontext(opened))
    monkeypatch.setattr(mcp_verb, "raise_priority", nullcontext)
    monkeypatch.setattr(mcp_verb, "load_setup", lambda *_: "setup")
    monkeypatch.setattr("kinesic.mcp.server.make_server", lambda *_, **__: SimpleNamespace(run=lambda transport: None))
    performers = SimpleNamespace(sinks=("twin",))
    try:
        result = mcp_verb.serve_tools(SimpleNamespace(options={}), performers, None, None, None)
    finally:
        sys.setswitchinterval(interval)
    assert result == code


@pytest.mark.parametrize(
    ("lines", "why"), [((), "it printed nothing"), (("a\n", "b\n", "c\n", "no robot\n"), "b c no robot")]
)
def test_last_lines_of_a_server_that_does_not_start_are_reported(lines: tuple[str, ...], why: str):
    opened: Future[object] = Future()
    _follow(SimpleNamespace(stderr=lines), opened, None)
    with pytest.raises(RobotError, match=f"does not start: {why}. Nothing can move"):
        opened.result(0)
