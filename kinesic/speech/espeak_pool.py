"""Pool of espeak-ng processes, one per utterance.

Starting a process and loading the library takes most of the time of a short utterance. The process of the next
utterance is therefore started while one is spoken.
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

from kinesic.extras import install_extra

ENGINE_TIMEOUT = 20.0  # [s] time limit for the synthesis of one text

_WORKER_SCRIPT = Path(__file__).with_name("espeak_process.py")
_LIBRARY_NAMES = {"Windows": "espeak-ng.dll", "Darwin": "libespeak-ng.dylib"}  # library file by operating system
_ready: dict[int, "subprocess.Popen[bytes]"] = {}  # waiting process by the process id of its parent


class SpeechError(RuntimeError):
    """Failure of the speech engine.

    The text gives the reason.
    """


@dataclass(frozen=True)
class EspeakPaths:
    """Paths of espeak-ng's library and data."""

    library: Path
    data: Path  # folder that contains espeak-ng-data


@dataclass(frozen=True)
class EngineReply:
    """Reply of espeak-ng with times in samples."""

    rate: int  # [Hz] sample rate
    marks: tuple[tuple[str, int], ...]
    phonemes: tuple[tuple[str, int], ...]  # symbol (empty for silence) and sample of its onset
    samples: bytes  # 16 bits per sample


@lru_cache(maxsize=1)
def find_engine() -> EspeakPaths | None:
    """Find the espeak-ng library installed by the extra `speech`.

    The result is None if it is missing.
    """
    spec = importlib.util.find_spec("espeakng_loader")
    if spec is None or not spec.submodule_search_locations:
        return None
    folder = Path(spec.submodule_search_locations[0])
    return EspeakPaths(folder / _LIBRARY_NAMES.get(platform.system(), "libespeak-ng.so"), folder)


@lru_cache(maxsize=1)
def espeak_fault() -> str:
    """Return why espeak-ng cannot speak, with a remedy.

    The result is empty if it can.
    """
    paths = find_engine()
    if paths is None:
        return f"espeak-ng is not installed: {install_extra('speech')}"
    try:
        synthesise("<speak>a</speak>", paths, voice="gmw/en-US", words_per_minute=175, pitch=50)
    except SpeechError as error:
        return str(error)
    return ""


def synthesise(text: str, place: EspeakPaths, *, voice: str, words_per_minute: int, pitch: int) -> EngineReply:
    """Synthesise one text in a separate process.

    Args:
        text: text in SSML.
        place: paths of the engine.
        voice: name of the voice in espeak-ng.
        words_per_minute: 80 to 450.
        pitch: 0 to 99; 50 is the voice's normal pitch.

    Raises:
        SpeechError: the engine fails, or needs longer than `ENGINE_TIMEOUT`.
    """
    request = json.dumps({"voice": voice, "words_per_minute": words_per_minute, "pitch": pitch, "text": text})
    process = _ready.pop(os.getpid(), None)
    try:
        process = process or _start(place)
        _send_text(process, request.encode())
        next_process = _start(place)  # while this one speaks
    except OSError as error:
        if process is not None:
            _end(process)
        raise SpeechError(f"espeak-ng cannot be run: {error}") from None
    if _ready.setdefault(os.getpid(), next_process) is not next_process:  # another thread stored one first
        _end(next_process)
    try:
        answer, errors = process.communicate(timeout=ENGINE_TIMEOUT)
    except subprocess.TimeoutExpired:
        _end(process)
        raise SpeechError(f"espeak-ng needs longer than {ENGINE_TIMEOUT:g} s") from None
    if process.returncode:
        why = errors.decode(errors="replace").strip().splitlines()
        raise SpeechError(why[-1] if why else f"espeak-ng ended with code {process.returncode}")
    header, _, samples = answer.partition(b"\n")
    reply = json.loads(header)
    marks, phonemes = (tuple((name, sample) for name, sample in reply[key]) for key in ("marks", "phonemes"))
    return EngineReply(reply["rate"], marks, phonemes, samples)


def _start(place: EspeakPaths) -> "subprocess.Popen[bytes]":
    """Start an espeak-ng process that waits for its text."""
    return subprocess.Popen(
        [sys.executable, "-I", "-S", str(_WORKER_SCRIPT), str(place.library), str(place.data)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def _send_text(process: "subprocess.Popen[bytes]", text: bytes) -> None:
    """Send the text to synthesise to an espeak-ng process.

    A process that has already ended reports its reason later.
    """
    assert process.stdin is not None  # a pipe, see `_start`
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
