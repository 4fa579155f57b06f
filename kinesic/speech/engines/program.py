"""Speech engine in a separate program on standard input and output.

The program gets one line of JSON for each phrase, and answers with one line of JSON and the samples
(docs/how-to/connect-a-voice.md). It starts with the first phrase and runs until kinesic ends, so that its model is
loaded once.
"""

import atexit
import os
import shlex
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, Literal

import msgspec
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.engines.phrase import EngineError, Phrase, SpokenPhrase, SpokenWord, UnreadableError
from kinesic.speech.recording import RecordingError, read_wav

ANSWER_TIMEOUT = 60.0  # [s] time limit for a phrase, including the start of the program
MAX_HEADER = 1_000_000  # [bytes] longest header line in a speech program's answer
MAX_SOUND = 100_000_000  # [bytes] largest accepted sound of a phrase
MIN_SAMPLE_RATE = 1000  # [Hz] lowest accepted sample rate of a program's sound
MAX_SAMPLE_RATE = 384_000  # [Hz] highest accepted sample rate of a program's sound
MAX_NAME = 60  # [characters] longest engine name in reports

# Running programs by process id of the parent, and command
_running: "dict[tuple[int, tuple[str, ...]], _Process]" = {}
_lock = threading.Lock()


class _Word(msgspec.Struct, frozen=True):
    """Word of a program's answer: characters and times [s]."""

    begin: int
    end: int
    start: float
    stop: float


class _Phoneme(msgspec.Struct, frozen=True):
    """Phoneme of a program's answer, with times [s]."""

    symbol: str
    start: float
    end: float
    onset: float | None = None  # [s] start of the mouth shape, if it differs from `start`
    release: float | None = None


class _Answer(msgspec.Struct, frozen=True):
    """First line of a program's answer, in JSON."""

    bytes: int = 0  # number of sound bytes that follow the answer
    format: Literal["s16le", "wav"] = "s16le"
    rate: int = 0  # [Hz] sample rate of sound in the format s16le
    words: tuple[_Word, ...] = ()
    phonemes: tuple[_Phoneme, ...] = ()
    accents: tuple[float, ...] = ()
    remarks: tuple[str, ...] = ()
    error: str = ""  # reason why the phrase cannot be spoken
    unreadable: bool = False  # whether the engine can read no word of the phrase, which is then left out


@dataclass(frozen=True)
class EngineProgram:
    """Speech engine that runs a command as a separate program."""

    command: tuple[str, ...]

    @classmethod
    def of(cls, text: str) -> "EngineProgram":
        """Create an engine from a command line.

        Raises:
            ConfigError: there is no such program.
        """
        try:
            command = tuple(shlex.split(text))
        except ValueError as error:
            raise ConfigError(f"the speech engine {text!r} is no command: {error}") from None
        if not command or shutil.which(command[0]) is None:
            raise ConfigError(f"the speech engine {text!r} cannot be run: no program {(*command, '')[0]!r}")
        return cls(command)

    @property
    def name(self) -> str:
        """Command, shortened, as the name in reports."""
        text = shlex.join(self.command)
        return text if len(text) <= MAX_NAME else f"{text[: MAX_NAME - 3]}..."

    def speak(self, phrase: Phrase, /) -> SpokenPhrase:
        """Synthesise a phrase by the program, started if necessary.

        Raises:
            UnreadableError: the program can read no word of the phrase.
            EngineError: the program does not run, or answers wrongly or too late.
        """
        with _lock:
            key = (os.getpid(), self.command)
            process = _running.pop(key, None) or _Process(self.command)
            answer, sound = process.ask(msgspec.json.encode(asdict(phrase)))
            _running[key] = process  # a failed one is not kept
        return _convert(answer, sound)


class _Process:
    """Process of a speech engine's program, asked line by line."""

    def __init__(self, command: Sequence[str]) -> None:
        """Start the program.

        Raises:
            EngineError: it cannot be started.
        """
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - open as long as the program runs
        try:
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors
            )
        except OSError as error:
            self._errors.close()
            raise EngineError(f"the program cannot be run: {error}") from None

    def ask(self, request: bytes) -> tuple[_Answer, bytes]:
        """Send one line to the program, and return its answer and sound.

        Raises:
            EngineError: the answer is wrong, too late or missing; the program is ended.
        """
        timer = threading.Timer(ANSWER_TIMEOUT, self._process.kill)
        timer.daemon = True
        timer.start()
        try:
            return self._exchange(request)
        except (EngineError, OSError) as error:
            why = str(error) if timer.is_alive() else f"no answer within {ANSWER_TIMEOUT:g} s"
            last_line = self.end()
            raise EngineError(f"{why}: {last_line}" if last_line else why) from None
        finally:
            timer.cancel()

    def end(self) -> str:
        """End the program, and return its last line of stderr."""
        self._process.kill()
        self._process.communicate()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        self._errors.close()
        return lines[-1] if lines else ""

    def _exchange(self, request: bytes) -> tuple[_Answer, bytes]:
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None  # pipes, see above
        assert stdout is not None
        stdin.write(request + b"\n")
        stdin.flush()
        line = stdout.readline(MAX_HEADER)
        if not line.endswith(b"\n"):
            raise EngineError("the program ended" if len(line) < MAX_HEADER else "its answer has no end of line")
        try:
            answer = msgspec.json.decode(line, type=_Answer)
        except (msgspec.DecodeError, RecursionError) as error:
            raise EngineError(f"its answer is no valid JSON: {error}") from None
        if not 0 <= answer.bytes <= MAX_SOUND:
            raise EngineError(f"its sound has {answer.bytes} bytes, must be 0 to {MAX_SOUND}")
        return answer, _read(stdout, answer.bytes)


def _read(stream: IO[bytes], count: int) -> bytes:
    sound = stream.read(count)
    if len(sound) < count:
        raise EngineError(f"its sound ends after {len(sound)} of {count} bytes")
    return sound


def _convert(answer: _Answer, sound: bytes) -> SpokenPhrase:
    """Convert an answer and its sound to a spoken phrase."""
    if answer.unreadable:
        raise UnreadableError(answer.error or "no word can be read")
    if answer.error:
        raise EngineError(answer.error)
    return SpokenPhrase(
        _read_sound(answer, sound),
        tuple(SpokenWord(word.begin, word.end, word.start, word.stop) for word in answer.words),
        tuple(
            Phoneme(item.symbol, item.start, max(item.end - item.start, 0.0), item.onset, item.release)
            for item in answer.phonemes
        ),
        answer.accents,
        answer.remarks,
    )


def _read_sound(answer: _Answer, sound: bytes) -> Sound:
    """Read the sound of an answer in its format."""
    if answer.format == "wav":
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "phrase.wav"
            path.write_bytes(sound)
            try:
                return read_wav(path)
            except RecordingError as error:
                raise EngineError(f"its sound is no WAV file: {error}") from None
    if not MIN_SAMPLE_RATE <= answer.rate <= MAX_SAMPLE_RATE or len(sound) % 2:
        raise EngineError(f"{len(sound)} bytes at {answer.rate} Hz are no samples of 16 bits")
    return Sound.of(answer.rate, np.frombuffer(sound, dtype="<i2") / 32768.0)


@atexit.register
def _dismiss() -> None:
    """End the programs that this process has started."""
    for key in [key for key in _running if key[0] == os.getpid()]:
        _running.pop(key).end()
