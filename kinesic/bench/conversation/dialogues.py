"""Scripted dialogues of a robot with people, generated from a seed."""

from dataclasses import dataclass

import numpy as np

from kinesic.conversation.events import (
    ConversationEvent,
    PeopleSeen,
    Person,
    Place,
    RobotSpeech,
    Transcript,
    TurnPrediction,
    VoiceActivity,
)

VOICE_BEGIN_DELAY = (0.077, 0.02)  # [s] mean and standard deviation of a detector's delay after a voice begins
VOICE_END_DELAY = (0.281, 0.01)  # [s] mean and standard deviation of a detector's delay after a voice ends
PAUSE_MEDIAN = 0.38  # [s] median of pauses within a turn
PAUSE_SPREAD = 0.45  # standard deviation of the logarithm of pauses
PAUSE_RANGE = (0.2, 1.5)  # [s] shortest and longest pause within a turn
UNFINISHED_PROBABILITY = 0.5  # probability that the words before a pause end with a conjunction or a hesitation
PREDICTOR_ERROR = 0.05  # probability that a predictor confuses a pause with the end of a turn, or the reverse
EXCHANGE_COUNT = 4  # number of turns of the person, and also of the robot, in a dialogue
TRACKER_PERIOD = 0.1  # [s] time between two reports of people

STANDING_PLACE: Place = (1.5, 0.3, 1.55)  # [m] position of the standing person's eyes

TimedEvent = tuple[float, ConversationEvent]


@dataclass(frozen=True, eq=False)
class Interjection:
    """Voice of a person during the robot's speech."""

    begin: float  # [s] start of the voice
    takes_turn: bool  # whether the person wants to speak; False for agreement and coughs


@dataclass(frozen=True, eq=False)
class Dialogue:
    """Events of one dialogue, with the true times behind them."""

    events: tuple[TimedEvent, ...]  # events in the order of their arrival
    turns: tuple[tuple[float, float], ...]  # [s] true start and end of the turns of the person
    speeches: tuple[tuple[float, float], ...]  # [s] planned start and end of the robot's speeches
    interjections: tuple[Interjection, ...]
    end: float  # [s] end of the dialogue
    has_predictor: bool  # whether a model predicts turns


def write_dialogue(seed: int) -> Dialogue:
    """Generate the dialogue of a seed."""
    return _Writer(seed).write()


class _Writer:
    """Generator of one dialogue's events."""

    def __init__(self, seed: int) -> None:
        self._random, self._time = np.random.default_rng(seed), 1.0
        self._events = list[TimedEvent]()
        self._has_predictor = seed % 2 == 1

    def write(self) -> Dialogue:
        turns, speeches, interjections = [], [], []
        for _ in range(EXCHANGE_COUNT):
            turns.append((self._time, self._write_turn()))
            begin = self._time + float(self._random.uniform(1.2, 2.5))
            end = begin + float(self._random.uniform(4.0, 12.0))
            self._events += [(begin, RobotSpeech(active=True, ends_in=end - begin)), (end, RobotSpeech(active=False))]
            speeches.append((begin, end))
            self._time = end + float(self._random.uniform(0.5, 2.0))
            interjections += self._interject(begin + 1.5, end - 1.8)
        self._write_people()
        events = tuple(sorted(self._events, key=lambda pair: pair[0]))
        times = tuple(turns), tuple(speeches)
        return Dialogue(events, *times, tuple(interjections), self._time, self._has_predictor)

    def _write_turn(self) -> float:
        """Write a person's turn, and return its end [s].

        The turn has one to four stretches of voice.
        """
        count = int(self._random.integers(1, 5))
        for number in range(count):
            end = self._time + float(self._random.uniform(0.9, 4.0))
            self._write_voice(self._time, end)
            is_last = number + 1 == count
            unfinished = not is_last and self._random.random() < UNFINISHED_PROBABILITY
            text = "we went to the lake and" if unfinished else "we went to the lake."
            self._events.append((end + 0.1, Transcript(text, final=is_last, who="p1")))
            if self._has_predictor:
                errs = self._random.random() < PREDICTOR_ERROR
                self._events.append((end + 0.15, TurnPrediction(0.85 if is_last != errs else 0.2)))
            self._time = end if is_last else end + self._pause()
        return self._time

    def _pause(self) -> float:
        pause = PAUSE_MEDIAN * float(np.exp(PAUSE_SPREAD * self._random.standard_normal()))
        return float(np.clip(pause, *PAUSE_RANGE))

    def _write_voice(self, begin: float, end: float) -> None:
        """Write a detector's reports of the start and end of a voice."""
        late = float(np.clip(self._random.normal(*VOICE_BEGIN_DELAY), 0.03, 0.2))
        after = float(np.clip(self._random.normal(*VOICE_END_DELAY), 0.25, 0.35))
        self._events += [
            (begin + late, VoiceActivity(active=True, who="p1", age=late)),
            (end + after, VoiceActivity(active=False, who="p1", age=after)),
        ]

    def _interject(self, earliest: float, latest: float) -> list[Interjection]:
        """Write agreement, a cough, an interruption or nothing during own speech."""
        kind = int(self._random.integers(0, 5))
        if kind == 0 or latest <= earliest:
            return []
        begin = float(self._random.uniform(earliest, latest))
        if kind in (1, 2):  # agreement, a cough
            self._write_voice(begin, begin + float(self._random.uniform(0.15, 0.42)))
            if kind == 1:
                self._events.append((begin + 0.3, Transcript("mhm", who="p1")))
            return [Interjection(begin, takes_turn=False)]
        self._write_voice(begin, begin + float(self._random.uniform(0.9, 1.6)))
        words = "wait" if kind == 3 else "but what about"
        self._events.append((begin + float(self._random.uniform(0.25, 0.6)), Transcript(words, who="p1")))
        return [Interjection(begin, takes_turn=True)]

    def _write_people(self) -> None:
        """Write tracker reports of a standing and a walking person.

        They contain dropouts and changed ids.
        """
        lost_until, id = 0.0, "p1"
        for time in np.arange(0.0, self._time, TRACKER_PERIOD).tolist():
            if time >= lost_until and self._random.random() < 0.01:
                lost_until = time + float(self._random.uniform(0.3, 0.9))
                id = "p1" if self._random.random() < 0.7 else f"p1-{int(10 * time)}"
            people = [] if time < lost_until else [Person(id, self._near(STANDING_PLACE), looks=True)]
            side = 2.0 - 0.5 * time % 8.0
            if abs(side) < 1.9:
                people.append(Person("walker", self._near((2.2, side, 1.6))))
            self._events.append((time, PeopleSeen(tuple(people), age=0.05)))

    def _near(self, place: Place) -> Place:
        x, y, z = (value + 0.01 * float(self._random.standard_normal()) for value in place)
        return x, y, z
