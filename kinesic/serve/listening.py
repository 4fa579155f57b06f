"""Microphone of the server, whose voices become messages of a conversation."""

from asyncio import AbstractEventLoop, get_running_loop
from collections.abc import Callable
from functools import partial
from threading import Lock, Thread

import numpy as np

from kinesic.body.utterance import Samples
from kinesic.hearing.barge_in import BargeInDecision
from kinesic.hearing.ear import FRAME_DURATION, Ear, HeardChange
from kinesic.hearing.microphone import SampleSource
from kinesic.serve.session import Session
from kinesic.serve.wire.conversing import ConverseRequest, HeardReport
from kinesic.speech.speaker import SAMPLE_RATE

NO_CLIENT = 0  # number of the sender of the server's own reports; no client has it
MAX_PLAYED_DURATION = 0.3  # [s] longest part of played sound that waits for the microphone


class PlayedSamples:
    """Samples sent to the loudspeaker, in order of sound."""

    def __init__(self, rate: int) -> None:
        """Create an empty queue for a rate [Hz]."""
        self._lock, self._waiting, self._rate = Lock(), np.zeros(0, np.float32), rate

    def add(self, samples: Samples) -> None:
        """Append samples (k,) that the loudspeaker got."""
        with self._lock:
            self._waiting = np.concatenate([self._waiting, samples])[-round(MAX_PLAYED_DURATION * self._rate) :]

    def take(self, count: int) -> Samples:
        """Remove and return the next samples (count,), silence where none wait."""
        with self._lock:
            taken, self._waiting = self._waiting[:count], self._waiting[count:]
        return np.concatenate([taken, np.zeros(count - len(taken), np.float32)])


def hear_people(session: Session, source: SampleSource) -> "HearingThread":
    """Begin a conversation that hears people, in a session.

    The robot is quiet while it hears a voice. Its own voice is removed from a source with the rate of the loudspeaker.
    """
    session.converse(ConverseRequest(), NO_CLIENT)
    played = None
    if session.speaker is not None and source.rate == SAMPLE_RATE:
        played = PlayedSamples(source.rate)
        session.speaker.monitor = played.add
    listener = HearingThread(source, get_running_loop(), partial(_react, session), played=played)
    listener.start()
    return listener


def _react(session: Session, change: HeardChange) -> None:
    """Mute the robot while a person speaks, and report the voice."""
    report = heard_report(change)
    if report is not None and session.converses:
        is_muted = bool(report.voice)
        session.loop.change_sound(lambda effects: effects.duck(on=is_muted))
        session.converse(report, NO_CLIENT)


class HearingThread(Thread):
    """Thread that reports the voices in a stream of samples."""

    def __init__(
        self,
        source: SampleSource,
        loop: AbstractEventLoop,
        report: Callable[[HeardChange], object],
        *,
        played: PlayedSamples | None = None,
    ) -> None:
        """Create a listener that has not started.

        Args:
            source: samples of the microphone.
            loop: event loop in which `report` is called.
            report: called with each change of a voice.
            played: samples of the robot's loudspeaker at the rate of the source; None: it is silent.
        """
        super().__init__(name="microphone", daemon=True)
        self._source, self._loop, self._report, self._played = source, loop, report, played
        self._is_ended = False

    def run(self) -> None:
        """Hear voices until the stream ends or `end` is called."""
        ear, count = Ear(self._source.rate), round(FRAME_DURATION * self._source.rate)
        while not self._is_ended and len(samples := self._source.read(count)):
            played = None if self._played is None else self._played.take(len(samples))
            for change in ear.hear(samples, played):
                if not self._loop.is_closed():
                    self._loop.call_soon_threadsafe(self._report, change)
        self._source.close()

    def end(self) -> None:
        """End the thread after the samples that it waits for."""
        self._is_ended = True


def heard_report(change: HeardChange) -> HeardReport | None:
    """Return the message for a change of a voice, if any.

    The conversation itself decides whether a lasting voice takes the turn.
    """
    match change.decision:
        case BargeInDecision.DUCK:
            return HeardReport(voice=True, age=change.age)
        case BargeInDecision.END:
            return HeardReport(voice=False, age=change.age)
        case BargeInDecision.YIELD:
            return None
