"""Runs espeak-ng: one process for each utterance, the next of which waits ready to speak.

Starting a process and reading the library takes most of the time of a short utterance; so that nobody waits for it,
the process of the next utterance is started when one has been said.
"""

import atexit
import importlib.util
import json
import os
import platform
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

INSTALL = "pip install 'kinesic[speech]'"
ENGINE_TIMEOUT = 20.0  # [s]

_PROGRAM = Path(__file__).with_name("espeak_process.py")
_SHARED = {"Windows": "espeak-ng.dll", "Darwin": "libespeak-ng.dylib"}
_ready: dict[int, "subprocess.Popen[bytes]"] = {}  # the one that waits, by the process that started it


class SpeechError(RuntimeError):
    """The engine fails; the text tells why."""


@dataclass(frozen=True)
class EspeakPaths:
    """Where espeak-ng is."""

    library: Path
    data: Path  # folder that holds espeak-ng-data


@dataclass(frozen=True)
class EngineReply:
    """What the engine answers; times in samples."""

    rate: int  # [Hz]
    marks: tuple[tuple[str, int], ...]
    phonemes: tuple[tuple[str, int], ...]  # symbol, empty for silence; sample of its onset
    samples: bytes  # 16 bits each


@lru_cache(maxsize=1)
def engine() -> EspeakPaths | None:
    """Finds the engine that the extra `speech` brings; None when it is not installed."""
    found = importlib.util.find_spec("espeakng_loader")
    if found is None or not found.submodule_search_locations:
        return None
    folder = Path(found.submodule_search_locations[0])
    return EspeakPaths(folder / _SHARED.get(platform.system(), "libespeak-ng.so"), folder)


@lru_cache(maxsize=1)
def espeak_fault() -> str:
    """Says why espeak-ng cannot speak here, and what mends it; empty when it can."""
    found = engine()
    if found is None:
        return f"espeak-ng is not installed: {INSTALL}"
    try:
        synthesise("<speak>a</speak>", found, voice="gmw/en-US", words_per_minute=175, pitch=50)
    except SpeechError as error:
        return str(error)
    return ""


def synthesise(text: str, place: EspeakPaths, *, voice: str, words_per_minute: int, pitch: int) -> EngineReply:
    """Synthesises one text.

    Args:
        text: in SSML.
        place: of the engine.
        voice: as the engine calls it.
        words_per_minute: 80 to 450.
        pitch: 0 to 99; 50 is the voice's own.

    Raises:
        SpeechError: the engine fails, or takes longer than `ENGINE_TIMEOUT`.
    """
    request = json.dumps({"voice": voice, "words_per_minute": words_per_minute, "pitch": pitch, "text": text})
    try:
        process = _ready.pop(os.getpid(), None) or _started(place)
        _ask(process, request.encode())
        following = _started(place)  # while this one speaks
    except OSError as error:
        raise SpeechError(f"espeak-ng cannot be run: {error}") from None
    if _ready.setdefault(os.getpid(), following) is not following:  # of another thread
        _end(following)
    try:
        answer, complaint = process.communicate(timeout=ENGINE_TIMEOUT)
    except subprocess.TimeoutExpired:
        _end(process)
        raise SpeechError(f"espeak-ng takes longer than {ENGINE_TIMEOUT:g} s") from None
    if process.returncode:
        why = complaint.decode(errors="replace").strip().splitlines()
        raise SpeechError(why[-1] if why else f"espeak-ng ended with code {process.returncode}")
    header, _, samples = answer.partition(b"\n")
    reply = json.loads(header)
    marks, phonemes = (tuple((name, sample) for name, sample in reply[key]) for key in ("marks", "phonemes"))
    return EngineReply(reply["rate"], marks, phonemes, samples)


def _started(place: EspeakPaths) -> "subprocess.Popen[bytes]":
    """Starts a process that reads the library and waits for its text."""
    return subprocess.Popen(
        [sys.executable, "-I", "-S", str(_PROGRAM), str(place.library), str(place.data)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def _ask(process: "subprocess.Popen[bytes]", text: bytes) -> None:
    """Hands over a text; a process that has ended already tells why when its answer is read."""
    assert process.stdin is not None  # a pipe, since `_started`
    with suppress(BrokenPipeError):
        process.stdin.write(text)
        process.stdin.close()
    process.stdin = None  # nothing more is written


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    process.communicate()


@atexit.register
def _dismiss() -> None:
    process = _ready.pop(os.getpid(), None)
    if process is not None:
        _end(process)
