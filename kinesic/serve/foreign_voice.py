"""Mouth motion, nods and beats for a client's speech sound."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.utterance import Sound
from kinesic.conversation.events import SoundPiece, SoundPosition
from kinesic.expressivity.face.loud_mouth import mouth_units
from kinesic.hearing.resampling import StreamResampler
from kinesic.realizer.following import NOD_DOWN_DURATION
from kinesic.realizer.foreign_sound import ForeignSound
from kinesic.speech.loudness import LOUDNESS_RATE, LoudnessMeter, find_stressed_syllables
from kinesic.speech.speaker import SAMPLE_RATE

START_DELAY = 0.2  # [s] time from the first part of a sound to its start, so that late parts cause no gap
MAX_STARVATION = 1.0  # [s] time without the next part after which the sound has ended
MAX_LEAD = 120.0  # [s] longest part of a sound that may wait to be played
MIN_POSITION_CHANGE = 0.05  # [s] smallest reported change of the playing position that is followed
KEPT_PIECE_DURATION = 1.0  # [s] time for which played parts are kept, so that they end undisturbed
NOD_RANGE = (2.0, 4.0)  # [deg] nods at the softest and the loudest stressed syllable
NOD_INTERVAL = 0.6  # [s] shortest time between two nods
BEAT_INTERVAL = 1.3  # [s] shortest time between two beats of a hand
BEAT_LEAD = 1.0  # [s] time before the stroke of a beat at which it is planned
MIN_BEAT_LEAD = 0.8  # [s] shortest time before a stroke at which a beat is still planned


@dataclass(frozen=True)
class Stress:
    """Stressed syllable that the robot accompanies."""

    time: float  # [s] global time
    strength: float  # 0..1 level of the syllable / highest level


class ForeignVoice:
    """Stream of one sound of a client, and its stressed syllables."""

    def __init__(self, id: str, rate: int, now: float) -> None:
        """Create the stream of a sound that begins soon."""
        self.id, self.rate = id, rate
        self._begin, self._duration = now + START_DELAY, 0.0
        self._resampler, self._meter = StreamResampler(rate, SAMPLE_RATE), LoudnessMeter(SAMPLE_RATE)
        self._pieces: list[tuple[float, Sound]] = []
        self._is_complete, self._searched = False, 0
        self._nods, self._beats = list[Stress](), list[Stress]()
        self._nod_count, self._last_nod, self._last_beat = 0, -inf, -inf

    def take(self, piece: SoundPiece, now: float) -> None:
        """Append a part of the sound.

        Raises:
            ValueError: too much of the sound waits to be played, or the rate has changed.
        """
        if piece.rate != self.rate:
            raise ValueError(f"rate {piece.rate} Hz after {self.rate} Hz; a sound has one rate")
        if self._begin + self._duration - now > MAX_LEAD:
            raise ValueError(f"{MAX_LEAD:g} s of sound wait already; send the rest later")
        samples = np.frombuffer(piece.data[: len(piece.data) // 2 * 2], "<i2").astype(np.float32) / 32768.0
        late = now - self._begin - self._duration
        silence = np.zeros(round(late * self.rate) if late > 0.0 and self._duration > 0.0 else 0, np.float32)
        resampled = self._resampler.feed(np.concatenate([silence, samples]))
        self._meter.feed(resampled)
        if piece.plays and len(resampled):
            self._pieces.append((self._begin + self._duration, Sound.of(SAMPLE_RATE, resampled)))
        self._duration += len(resampled) / SAMPLE_RATE
        self._is_complete |= piece.ends
        self._find_stresses()

    def move(self, position: SoundPosition, now: float) -> None:
        """Follow the reported position of a client that plays the sound itself."""
        change = now - position.at - self._begin
        if abs(change) >= MIN_POSITION_CHANGE:
            self._begin += change
            self._nods = [replace(stress, time=stress.time + change) for stress in self._nods]
            self._beats = [replace(stress, time=stress.time + change) for stress in self._beats]

    def sound(self, now: float) -> ForeignSound | None:
        """Return the rest of the sound at a time [s], if any."""
        if now >= self._begin + self._duration + (0.0 if self._is_complete else MAX_STARVATION):
            return None
        self._pieces = [
            (begin, sound) for begin, sound in self._pieces if begin + sound.duration > now - KEPT_PIECE_DURATION
        ]
        first = max(0, min(round((now - self._begin) * LOUDNESS_RATE) - 1, len(self._meter.levels)))
        highest = float(self._meter.levels.max(initial=0.0))
        face = mouth_units(self._meter.levels[first:], highest, step=1.0 / LOUDNESS_RATE)
        begin = self._begin + first / LOUDNESS_RATE
        return ForeignSound(self.id, self._begin, self._duration, self._is_complete, tuple(self._pieces), begin, face)

    def next_time(self) -> float:
        """Return the next time [s] of a nod, beat or sound end."""
        nods = [stress.time - NOD_DOWN_DURATION for stress in self._nods[:1]]
        beats = [stress.time - BEAT_LEAD for stress in self._beats[:1]]
        return min([*nods, *beats, self._begin + self._duration + (0.0 if self._is_complete else MAX_STARVATION)])

    def pop_nods(self, now: float) -> list[Stress]:
        """Remove and return the syllables for which a nod begins now."""
        due = [stress for stress in self._nods if stress.time - NOD_DOWN_DURATION <= now]
        self._nods = self._nods[len(due) :]
        return [stress for stress in due if stress.time > now]

    def pop_beats(self, now: float) -> list[Stress]:
        """Remove and return the syllables for which a beat is planned now."""
        due = [stress for stress in self._beats if stress.time - BEAT_LEAD <= now]
        self._beats = self._beats[len(due) :]
        return [stress for stress in due if stress.time - MIN_BEAT_LEAD > now]

    def _find_stresses(self) -> None:
        """Find stressed syllables in the parts received last."""
        levels = self._meter.levels
        for index in find_stressed_syllables(levels, self._searched):
            time, self._searched = self._begin + index / LOUDNESS_RATE, index + 1
            if time - self._last_nod < NOD_INTERVAL:
                continue
            self._nod_count, self._last_nod = self._nod_count + 1, time
            stress = Stress(time, min(1.0, float(levels[index] / levels.max())))
            self._nods.append(stress)
            if self._nod_count % 2 == 0 and time - self._last_beat >= BEAT_INTERVAL:
                self._last_beat = time
                self._beats.append(stress)
