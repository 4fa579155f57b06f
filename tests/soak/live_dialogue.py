"""Dialogues with a live server: people's voices in its hearing pipe, and messages of a tracker and a recogniser."""

import json
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from tempfile import TemporaryDirectory
from threading import Event, Thread
from time import monotonic, sleep

import numpy as np

from kinesic.bench.bml.server import _list_process_tree
from kinesic.bench.conversation.dialogues import Dialogue
from kinesic.bench.hearing.mixtures import ROBOT_TEXTS, SHORT_TEXTS, TURN_TEXTS
from kinesic.bench.hearing.sounds import make_cough, make_music, make_noise, say, say_as_robot, with_level
from kinesic.client import Client
from kinesic.conversation.events import PeopleSeen, Transcript, TurnPrediction, VoiceActivity
from kinesic.hearing.voice_activity import VOICE_RATE
from tests.soak import recorded_server

PERSON_LEVEL = 0.08  # root mean square of people's voices
MUSIC_LEVEL = 0.04  # root mean square of the music: 6 dB below the voices
NOISE_LEVELS = (0.008, 0.025)  # root mean squares of the noise: 20 and 10 dB below the voices
PERSON_PITCHES = (0.75, 1.3)  # pitch factors of the two people
FADE_SAMPLES = 160  # [samples] fade at both ends of a voice: 10 ms
PIPE_PART = 320  # [samples] sound that is written to the pipe at once: 20 ms
SENTENCE_GAP = 0.4  # [s] estimated pause between two sentences of the robot
SHORT_VOICE = 0.5  # [s] voices below this duration are agreement or coughs
MUSIC_EVERY = 2  # one of so many dialogues has music
AFTERMATH = 1.5  # [s] time after a dialogue before the next one


@dataclass(eq=False)
class LiveDialogue:
    """One performed dialogue with the messages of the server."""

    dialogue: Dialogue
    begin: float  # [s] machine time
    spans: list[tuple[float, float]]  # [s] true start and end of each voice of a person
    music: tuple[float, float] | None  # [s] start and end of the music
    told: list[tuple[float, dict[str, object]]] = field(default_factory=list)  # time [s] since the begin, and message
    speeches: list[float] = field(default_factory=list)  # [s] times at which the robot's texts were sent
    load: float = 0.0  # CPU time of all processes of the server / duration

    def states(self) -> list[tuple[float, str]]:
        """Return the time [s] and name of each new state."""
        named = [(time, str(message["state"])) for time, message in self.told if message.get("told") == "conversing"]
        return [pair for k, pair in enumerate(named) if k == 0 or named[k - 1][1] != pair[1]]


@dataclass(eq=False)
class LiveServer:
    """Running server with recordings, and the pipe of its microphone."""

    process: Popen
    port: int
    folder: Path
    _sound: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int16))
    _begin: float = 0.0  # [s] machine time of the first sample of the present sound
    _ended: Event = field(default_factory=Event)
    _ticks: dict[int, int] = field(default_factory=dict)  # CPU time of each process

    def hear(self, sound: np.ndarray, begin: float) -> None:
        """Let the server hear a sound from a machine time [s] on."""
        self._begin, self._sound = begin, (32767.0 * np.clip(sound, -1.0, 1.0)).astype("<i2")

    def feed(self) -> None:
        """Write the present sound, or silence, to the pipe in real time."""
        with (self.folder / "microphone").open("wb", buffering=0) as pipe:
            due = monotonic()
            while not self._ended.is_set():
                first = round((due - self._begin) * VOICE_RATE)
                part = self._sound[max(0, first) : first + PIPE_PART] if first >= 0 else self._sound[:0]
                pipe.write(np.pad(part, (0, PIPE_PART - len(part))).tobytes())
                due += PIPE_PART / VOICE_RATE
                sleep(max(0.0, due - monotonic()))

    def end(self) -> None:
        self._ended.set()

    def cpu(self) -> float:
        """Return the CPU time [s] of all processes of the server, at the last call for those that have ended."""
        for pid in _list_process_tree(self.process.pid):
            values = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            self._ticks[pid] = int(values[11]) + int(values[12])
        return sum(self._ticks.values()) / os.sysconf("SC_CLK_TCK")

    def recorded(self) -> tuple[np.ndarray, np.ndarray]:
        """Return all recorded commands and all recorded sound."""
        commands, sound = (np.fromfile(self.folder / name) for name in ("commands", "sound"))
        return commands, sound


@contextmanager
def live_server() -> Iterator[LiveServer]:
    """Start a server that hears a pipe, and record its commands and sound."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        os.mkfifo(folder / "microphone")
        options = ["--hear", str(folder / "microphone"), "--sound", "--listen", "127.0.0.1:0", "--learn", "none"]
        command = [sys.executable, "-m", recorded_server.__name__, name, *options]
        with Popen(command, stderr=PIPE, stdin=DEVNULL, text=True) as process:
            port = next(
                int(found[1]) for line in process.stderr if (found := re.search(r"listening at \S*:(\d+)", line))
            )
            server = LiveServer(process, port, folder)
            feeding = Thread(target=server.feed, daemon=True)
            feeding.start()
            try:
                yield server
            finally:
                server.end()
                process.terminate()
                feeding.join()


def perform_live(server: LiveServer, dialogue: Dialogue, seed: int) -> LiveDialogue:
    """Perform one dialogue in real time."""
    chance = np.random.default_rng(seed)
    spans = _voice_spans(dialogue)
    music = _place_music(dialogue, chance) if seed % MUSIC_EVERY == 0 else None
    sound = _sound_of(dialogue, spans, music, seed)
    timeline = [*dialogue.events, *((begin, _robot_text(end - begin, chance)) for begin, end in dialogue.speeches)]
    timeline.sort(key=lambda pair: pair[0])
    with Client(port=server.port) as client:
        client.do("converse")
        done = LiveDialogue(dialogue, monotonic() + 0.2, spans, music)
        server.hear(sound, done.begin)
        before = server.cpu()
        for time, event in timeline:
            _listen(client, done, time)
            _send(client, done, event)
        _listen(client, done, dialogue.end)
        done.load = (server.cpu() - before) / (monotonic() - done.begin)
        client.do("converse", on=False)
        _listen(client, done, dialogue.end + AFTERMATH)
    return done


def _listen(client: Client, done: LiveDialogue, until: float) -> None:
    """Record messages until a time [s] since the begin of the dialogue."""
    while (left := done.begin + until - monotonic()) > 0.0:
        message = client.receive(left)
        if message is not None and message.startswith("{"):
            done.told.append((monotonic() - done.begin, json.loads(message)))


def _send(client: Client, done: LiveDialogue, event: object) -> None:
    """Send an event, or a text of the robot; voices reach the server by its pipe alone."""
    match event:
        case PeopleSeen(people, age):
            reports = [{"id": person.id, "at": person.place, "looks": person.looks} for person in people]
            client.do("people", people=reports, age=age)
        case Transcript(text, final, who):
            client.do("heard", text=text, final=final, who=who)
        case TurnPrediction(yours):
            client.turn(yours)
        case str():
            done.speeches.append(monotonic() - done.begin)
            client.do("words", text=event, ends=True)


def _voice_spans(dialogue: Dialogue) -> list[tuple[float, float]]:
    """Return the true start and end [s] of each voice."""
    voices = [(time - event.age, event.active) for time, event in dialogue.events if isinstance(event, VoiceActivity)]
    begins = sorted(time for time, active in voices if active)
    ends = sorted(time for time, active in voices if not active)
    return list(zip(begins, ends, strict=True))


def _place_music(dialogue: Dialogue, chance: np.random.Generator) -> tuple[float, float] | None:
    """Return a time span [s] for music within a speech of the robot without interjections."""
    for begin, end in dialogue.speeches:
        if not any(begin < item.begin < end for item in dialogue.interjections) and end - begin > 4.5:
            first = begin + float(chance.uniform(0.8, 1.2))
            return first, first + 3.0
    return None


def _sound_of(
    dialogue: Dialogue, spans: list[tuple[float, float]], music: tuple[float, float] | None, seed: int
) -> np.ndarray:
    """Return the sound of people, coughs, music and noise at the microphone."""
    chance = np.random.default_rng(seed)
    sound = NOISE_LEVELS[seed // 2 % 2] * make_noise(chance, round(dialogue.end * VOICE_RATE))
    agreements = [time for time, event in dialogue.events if isinstance(event, Transcript) and event.text == "mhm"]
    for begin, end in spans:
        if end - begin >= SHORT_VOICE:
            voice = _speak(TURN_TEXTS, end - begin, seed, chance)
        elif any(begin < time < begin + SHORT_VOICE for time in agreements):
            voice = _speak(SHORT_TEXTS, end - begin, seed, chance)
        else:
            voice = make_cough(chance)
        _add(sound, with_level(voice, PERSON_LEVEL), begin)
    if music is not None:
        _add(sound, with_level(make_music(chance), MUSIC_LEVEL)[: round(3.0 * VOICE_RATE)], music[0])
    return sound


def _speak(texts: tuple[tuple[str, str], ...], duration: float, seed: int, chance: np.random.Generator) -> np.ndarray:
    """Return the voice of one person for a duration [s]."""
    count, parts = round(duration * VOICE_RATE), []
    while sum(map(len, parts)) < count:
        language, text = texts[chance.integers(len(texts))]
        parts.append(say(text, language, 1.0, PERSON_PITCHES[seed % 2]))
    voice = np.concatenate(parts)[:count].astype(np.float64)
    ramp = np.linspace(0.0, 1.0, FADE_SAMPLES)
    voice[:FADE_SAMPLES] *= ramp
    voice[-FADE_SAMPLES:] *= ramp[::-1]
    return voice


def _add(sound: np.ndarray, part: np.ndarray, begin: float) -> None:
    first = round(begin * VOICE_RATE)
    part = part[: len(sound) - first]
    sound[first : first + len(part)] += part


def _robot_text(duration: float, chance: np.random.Generator) -> str:
    """Return sentences that the robot says in about a duration [s], at least one."""
    sentences, left = [], duration
    for number in chance.permutation(len(ROBOT_TEXTS)).tolist():
        length = len(say_as_robot(ROBOT_TEXTS[number])) / VOICE_RATE + SENTENCE_GAP
        if sentences and length > left:
            break
        sentences.append(ROBOT_TEXTS[number])
        left -= length
    return " ".join(sentences)
