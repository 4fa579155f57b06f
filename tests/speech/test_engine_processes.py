"""Tests of speech engine processes with a fake engine program."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.speech import espeak_pool
from kinesic.speech.espeak_pool import EngineReply, EspeakPaths, SpeechError, synthesise

ENGINE_PROGRAM = """
import json, sys
request = json.loads(sys.stdin.read() or "{}")
if request.get("text") == "fail":
    print("first line", file=sys.stderr)
    print("the reason", file=sys.stderr)
if request.get("text") in ("fail", "fail silently"):
    sys.exit(3)
header = {"rate": 22050, "marks": [["m", 5]], "phonemes": [["a", 0], ["", 9]]}
sys.stdout.buffer.write(json.dumps(header).encode() + b"\\n" + json.dumps([request, *sys.argv[1:]]).encode())
"""
ENGINE_PATHS = EspeakPaths(Path("library.so"), Path("data"))
VOICE_SETTINGS = {"voice": "v", "words_per_minute": 200, "pitch": 40}


@pytest.fixture
def started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[subprocess.Popen]]:
    """Record the processes of a fake engine in order of start."""
    program = tmp_path / "program.py"
    program.write_text(ENGINE_PROGRAM)
    monkeypatch.setattr(espeak_pool, "_WORKER_SCRIPT", program)
    espeak_pool._dismiss()
    processes, popen = [], subprocess.Popen

    def start(*arguments, **options) -> subprocess.Popen:
        processes.append(popen(*arguments, **options))
        return processes[-1]

    monkeypatch.setattr(espeak_pool.subprocess, "Popen", start)
    yield processes
    espeak_pool._dismiss()
    for process in processes:
        if process.poll() is None:
            process.kill()
            process.communicate()


def test_engine_receives_the_text_and_its_reply_is_parsed(started: list[subprocess.Popen]) -> None:
    reply = synthesise("hello", ENGINE_PATHS, **VOICE_SETTINGS)
    request = {**VOICE_SETTINGS, "text": "hello"}
    assert json.loads(reply.samples) == [request, "library.so", "data"]
    assert reply == EngineReply(22050, (("m", 5),), (("a", 0), ("", 9)), reply.samples)


def test_engine_process_for_the_next_text_starts_in_advance(started: list[subprocess.Popen]) -> None:
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    first, waiting = started
    assert first.poll() == 0
    assert waiting.poll() is None
    assert json.loads(synthesise("two", ENGINE_PATHS, **VOICE_SETTINGS).samples)[0]["text"] == "two"
    assert len(started) == 3
    assert waiting.poll() == 0


def test_forked_process_does_not_use_the_waiting_speech_engine_of_its_parent(
    started: list[subprocess.Popen], monkeypatch
) -> None:
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    with monkeypatch.context() as child:
        child.setattr(espeak_pool.os, "getpid", lambda: -1)
        synthesise("two", ENGINE_PATHS, **VOICE_SETTINGS)
        espeak_pool._dismiss()
    assert started[1].poll() is None
    assert len(started) == 4


def test_surplus_waiting_engine_process_is_stopped(started: list[subprocess.Popen], monkeypatch) -> None:
    """Store a second waiting process, as another thread might."""
    send_text = espeak_pool._send_text

    def send(process: subprocess.Popen, text: bytes) -> None:
        espeak_pool._ready[os.getpid()] = espeak_pool._start(ENGINE_PATHS)
        send_text(process, text)

    monkeypatch.setattr(espeak_pool, "_send_text", send)
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    _, stored, surplus = started
    assert surplus.poll() is not None
    assert stored.poll() is None
    assert espeak_pool._ready[os.getpid()] is stored


@pytest.mark.parametrize(
    ("text", "why"), [("fail", "^the reason$"), ("fail silently", "^espeak-ng ended with code 3$")]
)
def test_failure_of_the_speech_engine_is_reported_with_its_error_message_or_exit_code(
    started: list[subprocess.Popen], text: str, why: str
) -> None:
    with pytest.raises(SpeechError, match=why):
        synthesise(text, ENGINE_PATHS, **VOICE_SETTINGS)


def test_killed_waiting_engine_process_reports_its_exit_code(started: list[subprocess.Popen]) -> None:
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    started[-1].kill()
    started[-1].wait()
    with pytest.raises(SpeechError, match="ended with code -9"):
        synthesise("two", ENGINE_PATHS, **VOICE_SETTINGS)


def test_missing_engine_program_is_reported(started: list[subprocess.Popen], monkeypatch) -> None:
    monkeypatch.setattr(espeak_pool.sys, "executable", "/no/python")
    with pytest.raises(SpeechError, match=r"espeak-ng cannot be run: .*/no/python"):
        synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)


def test_waiting_engine_process_is_stopped_if_no_next_one_can_start(
    started: list[subprocess.Popen], monkeypatch
) -> None:
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    monkeypatch.setattr(espeak_pool.sys, "executable", "/no/python")
    with pytest.raises(SpeechError, match=r"espeak-ng cannot be run: .*/no/python"):
        synthesise("two", ENGINE_PATHS, **VOICE_SETTINGS)
    waiting = started[-1]
    assert waiting.returncode is not None
    assert waiting.stdout.closed
    assert waiting.stderr.closed


def test_speech_engine_process_beyond_its_time_limit_is_stopped(started: list[subprocess.Popen], monkeypatch) -> None:
    monkeypatch.setattr(espeak_pool, "ENGINE_TIMEOUT", 0.0)
    with pytest.raises(SpeechError, match="needs longer than 0 s"):
        synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    assert started[0].poll() is not None


def test_waiting_engine_process_is_stopped_at_exit(started: list[subprocess.Popen]) -> None:
    synthesise("one", ENGINE_PATHS, **VOICE_SETTINGS)
    espeak_pool._dismiss()
    assert started[1].poll() == -9
    assert espeak_pool._ready == {}
    espeak_pool._dismiss()


@pytest.mark.parametrize(
    ("system", "library"),
    [("Windows", "espeak-ng.dll"), ("Darwin", "libespeak-ng.dylib"), ("Linux", "libespeak-ng.so")],
)
def test_espeak_library_file_of_each_system_is_found_in_the_installed_package(
    system: str, library: str, monkeypatch
) -> None:
    spec = SimpleNamespace(submodule_search_locations=["/packages/espeakng_loader"])
    monkeypatch.setattr("importlib.util.find_spec", lambda name: spec if name == "espeakng_loader" else None)
    monkeypatch.setattr(espeak_pool.platform, "system", lambda: system)
    folder = Path("/packages/espeakng_loader")
    assert espeak_pool.find_engine.__wrapped__() == EspeakPaths(folder / library, folder)
    spec.submodule_search_locations = None
    assert espeak_pool.find_engine.__wrapped__() is None


def test_speech_engine_that_cannot_be_started_is_reported_as_unavailable(
    started: list[subprocess.Popen], monkeypatch
) -> None:
    monkeypatch.setattr(espeak_pool, "find_engine", lambda: ENGINE_PATHS)
    assert espeak_pool.espeak_fault.__wrapped__() == ""
    monkeypatch.setattr(espeak_pool.sys, "executable", "/no/python")
    assert "cannot be run" in espeak_pool.espeak_fault.__wrapped__()
    monkeypatch.setattr(espeak_pool.sys, "executable", sys.executable)
