"""Random choice of lexemes without recent repetitions."""

import random
from bisect import bisect_left, bisect_right, insort
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from kinesic.intent.behaviour_sets import Channel, Choice
from kinesic.intent.behaviours import ChosenBehaviour, Omission, name_form
from kinesic.intent.greta.agent import Agent
from kinesic.intent.intents import Intent
from kinesic.intent.meaning.feelings import EMOTION_PREFIX
from kinesic.intent.pacing.beat_spans import select_fitting
from kinesic.intent.pacing.candidates import Candidate
from kinesic.intent.pacing.long_strokes import stroke_delay
from kinesic.intent.pacing.memory import PastGesture
from kinesic.intent.pacing.rhythm import BEAT_INTENTS, MAIN_BEAT_INTENT, is_beat

NO_REPEAT_WINDOW = 3  # [gestures] successive gestures that must differ if no time window is given
BEAT_REASON = "{}; a beat, as its gesture was shown a moment ago"  # reason of a beat that replaces a repeated gesture
# Intents whose words recur in any text.
FUNCTION_INTENTS = frozenset({"negation", "negative", "question", "rhetorical"})
EMPHATIC_CERTAINTY = 0.8  # smallest certainty of an intent whose beat is as expressive as the style's other gestures
MIN_REPEAT_INTERVAL = 8.0  # [s] smallest time between equal gestures, if all alternatives are used up


@dataclass(eq=False)
class GestureUses:
    """Stroke times of each gesture, to avoid repetitions."""

    window: float  # [s] time without repeated gestures; 0: three successive gestures differ
    _times: dict[str, list[float]] = field(default_factory=dict)  # form -> sorted times of strokes [s]
    _reasons: set[tuple[str, str]] = field(default_factory=set)  # (form, reason) of each use
    _recent: list[str] = field(default_factory=list)  # forms of the last gestures

    def add(self, past: PastGesture) -> None:
        """Add one gesture to the record of shown gestures."""
        insort(self._times.setdefault(past.form, []), past.seconds)
        self._reasons.add((past.form, past.reason))
        self._recent = [*self._recent, past.form][-(NO_REPEAT_WINDOW - 1) :]

    def interval(self, form: str, at: float) -> float:
        """Return the time [s] to the gesture's nearest stroke, or infinity."""
        times = self._times.get(form, [])
        place = bisect_left(times, at)
        return min((abs(at - time) for time in times[max(place - 1, 0) : place + 1]), default=float("inf"))

    def select(self, candidate: Candidate, at: float) -> Sequence[Choice]:
        """Return the alternative gestures not shown recently.

        A beat may use the one shown longest ago. So may a gesture for words that the text repeats, unless it is one of
        the last two. Otherwise the first substitute that was not shown recently follows.
        """
        choices, intent = candidate.choices, candidate.intent
        forms = {choice: name_form(choice.lexeme, intent) for choice in choices}
        if not self.window:
            return [choice for choice in choices if forms[choice] not in self._recent]
        fresh = self.fresh(choices, intent, at)
        if fresh:
            return fresh
        is_repeated = intent.name not in FUNCTION_INTENTS and intent.name not in BEAT_INTENTS
        repeated = [choice for choice in choices if is_repeated and (forms[choice], intent.reason) in self._reasons]
        again = [item for item in repeated if forms[item] not in self._recent]
        oldest = self.oldest(choices if intent.name in BEAT_INTENTS else again, intent, at)
        return oldest or self.fresh(candidate.substitutes, intent, at)[:1]

    def fresh(self, choices: Sequence[Choice], intent: Intent, at: float) -> Sequence[Choice]:
        """Return the alternatives not shown within the window."""
        return [choice for choice in choices if self.interval(name_form(choice.lexeme, intent), at) >= self.window]

    def oldest(self, choices: Sequence[Choice], intent: Intent, at: float) -> Sequence[Choice]:
        """Return the alternative shown longest ago, empty if all are recent."""
        intervals = {choice: self.interval(name_form(choice.lexeme, intent), at) for choice in choices}
        free = [choice for choice in choices if intervals[choice] >= MIN_REPEAT_INTERVAL]
        return [max(free, key=lambda choice: intervals[choice])] if free else []

    def explain(self, candidate: Candidate) -> str:
        """Return the reason why no alternative gesture is left."""
        lexeme = candidate.choices[0].lexeme
        if self.window:
            return f"{lexeme} is shown within {self.window:g} s"
        return f"{lexeme} was among the last {NO_REPEAT_WINDOW - 1} gestures"


def prefer(choices: Sequence[Choice], preferences: Mapping[str, float], intent: str) -> tuple[Choice, ...]:
    """Weight alternative gestures by the preferences of a style.

    Args:
        choices: alternatives of one intent.
        preferences: gesture -> factor on its probability.
        intent: its name; preferred beats are further alternatives of intents that show beats.
    """
    weighted = [
        replace(choice, probability=choice.probability * preferences.get(choice.lexeme, 1.0)) for choice in choices
    ]
    if intent in BEAT_INTENTS and choices:
        present = {choice.lexeme for choice in choices}
        usual = sum(choice.probability for choice in choices) / len(choices)
        added = ((name, factor) for name, factor in preferences.items() if factor > 1.0 and is_beat(name))
        weighted += [Choice(name, factor * usual) for name, factor in added if name not in present]
    return tuple(weighted)


def _make_beat(intent: Intent, slowness: float) -> Intent:
    """Convert an intent with a recently shown gesture into a beat intent.

    Its stroke falls on the word, without the delay of a long stroke, which depends on the slowness of the style.
    """
    return replace(
        intent,
        name=MAIN_BEAT_INTENT,
        reason=BEAT_REASON.format(intent.reason),
        stroke=intent.stroke.later(-stroke_delay(intent.lexemes, slowness)),
        lexemes=(),
        target="",
        hand="",
    )


def _fitting(candidate: Candidate, times: Sequence[float]) -> tuple[Choice, ...]:
    """Return a candidate's alternatives that fit between the neighbouring strokes.

    Args:
        candidate: gesture to choose.
        times: of all strokes, sorted [s].
    """
    at = candidate.intent.stroke.seconds
    before, after = bisect_left(times, at), bisect_right(times, at)
    last = times[before - 1] if before else float("-inf")
    following = times[after] if after < len(times) else float("inf")
    return tuple(select_fitting(candidate.choices, at - last, following - at))


@dataclass(frozen=True, eq=False)
class LexemeSampler:
    """Random choice of lexemes on one channel, without recently used gestures."""

    channel: Channel
    agent: Agent  # agent whose preferences and expressivity apply
    generator: random.Random
    omitted: list[Omission]  # receives candidates without an unused alternative
    uses: GestureUses  # gestures shown so far, to which chosen gestures are added
    offset: float  # [s] added to times of intents to get times of `uses`
    beats: Sequence[Choice]  # forms that replace a gesture without an unused alternative
    beat_manner: Mapping[str, float]  # expressivity of beats, where it differs from the style
    preferences: Mapping[str, float]  # gesture -> factor on its probability
    slowness: float = 1.0  # factor on the duration of long strokes

    def draw(self, kept: Sequence[Candidate], *, others: Sequence[float] = ()) -> Iterable[ChosenBehaviour]:
        """Yield a behaviour with a random lexeme for each new candidate.

        Preferred beats are added to the alternatives of beats.

        Args:
            kept: candidates in the order of their strokes.
            others: times of the strokes of other gestures [s].
        """
        times = sorted([*others, *(candidate.intent.stroke.seconds for candidate in kept)])
        for kept_candidate in kept:
            candidate = kept_candidate
            if self.channel == "gesture" and self.preferences:
                candidate = replace(
                    candidate, choices=prefer(candidate.choices, self.preferences, candidate.intent.name)
                )
            if self.channel == "gesture":
                candidate = replace(candidate, choices=_fitting(candidate, times))
            intent, at = candidate.intent, candidate.intent.stroke.seconds + self.offset
            if candidate.earlier is not None:
                if self.channel == "gesture":
                    self.uses.add(PastGesture(candidate.earlier.form, at, intent.reason))
                continue
            free = self.uses.select(candidate, at) if self.channel == "gesture" else candidate.choices
            if not free and self.uses.window:
                beat = _make_beat(intent, self.slowness)
                near = sorted([*others, *(each.intent.stroke.seconds for each in kept if each is not kept_candidate)])
                fitting = _fitting(replace(candidate, intent=beat, choices=tuple(self.beats)), near)
                at = beat.stroke.seconds + self.offset
                free = self.uses.oldest(fitting, beat, at)
                intent = beat if free else intent
            if not free:
                self.omitted.append(Omission(intent, self.channel, self.uses.explain(candidate)))
                continue
            choice = self.generator.choices(free, [max(item.probability, 1e-6) for item in free])[0]
            if self.channel == "gesture":
                self.uses.add(PastGesture(name_form(choice.lexeme, intent), at, intent.reason))
            manner = self._manner(intent, choice.lexeme)
            yield ChosenBehaviour(self.channel, choice.lexeme, intent, choice.amount, choice.repetition, manner)

    def _manner(self, intent: Intent, lexeme: str) -> Mapping[str, float]:
        """Return the expressivity parameters of a lexeme that differ from the style.

        Only gestures of feelings are repeated, as a second stroke of others would accompany other words.
        """
        manner = self.agent.manner(intent.name, self.channel, intent.strength)
        if self.channel == "gesture" and is_beat(lexeme) and intent.certainty < EMPHATIC_CERTAINTY:
            return {**self.beat_manner, **manner}
        if self.channel == "gesture" and not is_beat(lexeme) and not intent.name.startswith(EMOTION_PREFIX):
            return {**{name: value for name, value in self.beat_manner.items() if name == "repetition"}, **manner}
        return manner
