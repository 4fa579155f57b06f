"""Effort: how much time and force each phase of a gesture gets, by what the gesture is and in which manner it is done.

People take nearly the same time for short and long ways, so that speed follows distance; they put their force into the
stroke, pass through its keys and go home unhurried (Kendon; Laban's effort of time). Measured on 241 captured gestures,
the duration of a way grows with its length to the power of 0.1 to 0.3. No time is shorter than what the servos need.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import log2
from typing import Literal

from kinesic.expressivity.style.pace import HASTE, Pace, hurry_time, natural_time
from kinesic.expressivity.style.style import LEAST_LATE, NEUTRAL, Expressivity, Phase, passage_of
from kinesic.motion.keys import EVEN, STEEPEST, KeyPassage

Tempo = Literal["sudden", "neutral", "sustained"]

PACES: Mapping[Tempo, float] = {"sudden": 0.48, "neutral": 1.0, "sustained": 2.1}  # factors on time
POSE_TIME = 1.3  # factor on the time of a gesture that is a pose
CALM = 0.5  # exponent of slowness on the way home; who acts quickly goes home no faster
SPREAD = 0.5  # exponent of a tempo in the stroke, which has its length in time from its meaning

PREPARATION, RETURN, STROKE = 0.56, 0.96, 0.47  # [s] of a way of usual length
WAY, SWING_WAY = 0.9, 0.35  # [arm lengths] of such a way from rest, and in a stroke
SHORTEST_WAY = 0.02  # [arm lengths] below which no way takes less time
FLAT, FLATTER, STEEP = 0.10, 0.25, 0.4  # exponents of the length: of the way there, back, and in a stroke
PLAIN_BEGIN, PLAIN_BIT, PLAIN_WIDTH = 0.1, 0.15, 0.05  # [s], [s] and [m] of a target in Fitts' law
PLAIN_FORCEFUL, PLAIN_HOLD = 2.4, 0.5  # times the least time of a stroke without any effort, and shares of it as hold
READY, EASY, FORCEFUL = 1.05, 1.3, 1.6  # times what the servos need at least; an accent needs half as much again
ROOM_FOR_ACCENT = (
    1.5  # times the same that power leaves a stroke: with less the servos round its accent off, and it is no faster
)
CARRIED = 0.6  # of weakness: what the ways there and back have of it (Greta's share)

BEAT_TIME = 0.6  # [s] of a stroke after which the hand is held as long as its category says
DWELL, DYNAMIC_DWELL = 1.8, 0.4  # factors on the hold of a pose, and of a stroke of `BEAT_TIME`

ACCENT = 1.9  # steepness that a dynamic stroke adds to the softest
SPOKEN_ACCENT = 6.4  # likewise where a word sounds at its end: people's hands are fastest at the accented syllable
ONWARD, THROUGH = 0.9, 0.8  # swing at the key where a stroke begins, and at its other keys
SPOKEN_ONWARD = 0.4  # at the key where one begins that meets a word: the rest of the speed is kept for the word
SPOKEN_LOOSE = -0.15  # tension there at least, however loose the hand
ALONG = 0.4  # swing at both ends of a path, from which the hand must not stray
CROWDED = 0.7  # share of its natural time from which on a way has neither swing nor accent
UNHURRIED = 7.5  # steepness of the linear easing of the way home: a third faster than its mean
SOFTENED = 1.6  # exponent with which fluidity makes the way home begin and end softly
FIRM = 0.5  # power, tension or stiffness that takes the whole swing away
LOOSE = 0.3  # of the swing, which a tension of -1 has by itself


@dataclass(frozen=True)
class Character:
    """How gestures of one category are done."""

    time: float  # factor on the time of all ways
    hold: float  # [s] after a stroke of usual length


USUAL = Character(1.0, 0.30)
CHARACTERS: Mapping[str, Character] = {
    "beat": Character(0.85, 0.17),
    "deictic": Character(0.9, 0.45),
    "emblem": Character(0.95, 0.35),
    "iconic": Character(1.0, 0.25),
    "emotion": Character(1.0, 0.45),
    "metaphoric": Character(1.1, 0.30),
    "adaptor": Character(1.3, 0.30),
    "rest": Character(1.6, 0.30),
}


@dataclass(frozen=True)
class Nature:
    """What a gesture is, as far as its effort depends on it."""

    category: str = ""  # of the lexicon, or anybody's own
    tempo: Tempo = "neutral"
    dynamic: bool = True  # the hand goes a way of its own in the stroke; else it comes to a pose and stays
    weight: float = 1.0  # of all that: 0 hands are as fast as servos are at ease, and stop at every key .. 1


PLAIN_NATURE = Nature()


@dataclass(frozen=True, eq=False)
class Effort:
    """Times and passages of one gesture on one robot; documents that give times keep theirs."""

    pace: Pace  # what the robot can
    nature: Nature = PLAIN_NATURE
    manner: Expressivity = NEUTRAL
    spoken: bool = False  # a word sounds at the stroke: the hand is fastest near it, and not when it sets out

    @cached_property
    def slowness(self) -> float:
        """Factor on time by what the gesture is."""
        return self._character.time * PACES[self.nature.tempo] * (1.0 if self.nature.dynamic else POSE_TIME)

    def preparation_time(self, distance: float) -> float:
        """Finds the natural time of the way from rest to a stroke [s].

        Args:
            distance: [m]; the shortest times that servos need grow with it.
        """
        return self._way_time(distance, self.slowness, READY)

    def joining_time(self, distance: float) -> float:
        """Finds the natural time of the way from another gesture to the stroke [s]; it is never slow."""
        return self._way_time(distance, min(self.slowness, 1.0), EASY)

    def return_time(self, distance: float) -> float:
        """Finds the natural time of the way from a hold to rest [s], which nothing hurries."""
        ease = RETURN * max(self.slowness, 1.0) ** CALM * self._length(distance, WAY) ** FLATTER
        least = self.pace.least_hand_time(distance)
        ease = self._blend(max(ease, EASY * least), max(_fitts(distance), EASY * least))
        return natural_time(ease, least, self.manner.temporal, CARRIED * min(self.manner.power, 0.0))

    def stroke_time(self, distance: float) -> float:
        """Finds the natural time of one swing of a stroke [s]; power moves its force here."""
        ease = STROKE * self.slowness**SPREAD * self._length(distance, SWING_WAY) ** STEEP
        least = self.pace.least_hand_time(distance)
        ease = self._blend(max(ease, FORCEFUL * least), max(_fitts(distance), PLAIN_FORCEFUL * least))
        return natural_time(ease, least, self.manner.temporal, self.manner.power, room=ROOM_FOR_ACCENT)

    def hold_time(self, stroke: float) -> float:
        """Finds how long the hand stays after a stroke, which took so many seconds in plain manner [s]."""
        dwell = DYNAMIC_DWELL * stroke / BEAT_TIME if self.nature.dynamic else DWELL
        return hurry_time(
            self._blend(self._character.hold * dwell, PLAIN_HOLD * stroke), 0.0, self.manner.temporal, HASTE
        )

    def passage(self, phase: Phase, *, led: bool = False, leisure: float = 1.0, stroke: bool = True) -> KeyPassage:
        """Derives how the hand passes a key.

        Args:
            phase: that the way to the key belongs to.
            led: whether a path begins or ends at the key, along which the hand speeds up and slows down by itself.
            leisure: the share of its natural time that the gesture has, its neighbours considered.
            stroke: whether the key is a stroke, which a word may meet.
        """
        manner = self.manner
        if phase == "retraction":
            soft, stiff = max(manner.fluidity, 0.0), max(-manner.fluidity, 0.0)
            even = EVEN + (UNHURRIED - EVEN) * (1.0 - soft) ** SOFTENED + (STEEPEST - UNHURRIED) * stiff
            home = replace(passage_of(manner, phase), easing="linear", steepness=self._blend(even, EVEN))
            return home if self.nature.weight > 0.0 else passage_of(manner, phase)
        if phase == "hold":
            return passage_of(manner, phase)
        if phase == "preparation":
            manner = replace(manner, power=min(manner.power, 0.0))
            if self.spoken:  # who comes with a rush is fastest there, and not at the word
                manner = replace(manner, fluidity=min(manner.fluidity, 0.0), tension=max(manner.tension, SPOKEN_LOOSE))
        free = self.nature.weight * min(max((leisure - CROWDED) / (1.0 - CROWDED), 0.0), 1.0)
        onward = SPOKEN_ONWARD if self.spoken else ONWARD
        swing = self._suppleness * (ALONG if led else onward if phase == "preparation" else THROUGH)
        accent = self._accent(met=self.spoken and stroke) if phase == "stroke" and not led else 0.0
        swing = free * swing if self.nature.dynamic else 0.0
        return passage_of(manner, phase, accent=free * accent, late=self.spoken, swing=swing)

    @property
    def plain(self) -> "Effort":
        """The same gesture in no manner."""
        return replace(self, manner=NEUTRAL)

    @property
    def _suppleness(self) -> float:
        """Factor on all swings: who is forceful, tense or stiff goes straight from key to key."""
        firmness = max(self.manner.power, self.manner.tension, -self.manner.fluidity, 0.0)
        return max(1.0 - firmness / FIRM, 0.0) * (1.0 + LOOSE * min(self.manner.tension, 0.0))

    @property
    def _abruptness(self) -> float:
        """Factor on all accents: jerky hands begin their strokes at once, fluid and loose ones softly."""
        return (1.0 - self.manner.fluidity) * (1.0 + min(self.manner.tension, 0.0))

    def _accent(self, *, met: bool) -> float:
        """Steepness that a way of a stroke adds to the softest; where a word meets one, that way alone has any."""
        if met:
            return max(self._abruptness, LEAST_LATE / SPOKEN_ACCENT) * SPOKEN_ACCENT
        return self._abruptness * ACCENT if self.nature.dynamic and not self.spoken else 0.0

    @property
    def _character(self) -> Character:
        return CHARACTERS.get(self.nature.category.lower(), USUAL)

    def _way_time(self, distance: float, slowness: float, easy: float) -> float:
        """Time of the way to a stroke [s]: weakness slows it, power is kept for the stroke."""
        least = self.pace.least_hand_time(distance)
        ease = PREPARATION * slowness * self._length(distance, WAY) ** FLAT
        weakness = CARRIED * min(self.manner.power, 0.0)
        ease = self._blend(max(ease, easy * least), max(_fitts(distance), EASY * least))
        return natural_time(ease, least, self.manner.temporal, weakness)

    def _blend(self, ours: float, plain: float) -> float:
        """What this gesture has of an amount, and of the one that it would have without any effort."""
        return plain + self.nature.weight * (ours - plain)

    def _length(self, distance: float, usual: float) -> float:
        """Length of a way [m] in usual ones [arm lengths]."""
        return max(distance / self.pace.robot.arm_length, SHORTEST_WAY) / usual


def _fitts(distance: float) -> float:
    """Time of a way of the hand by Fitts' law [s], which knows neither phase nor gesture."""
    return PLAIN_BEGIN + PLAIN_BIT * log2(distance / PLAIN_WIDTH + 1.0)
