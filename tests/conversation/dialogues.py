"""Conversations in virtual time."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from kinesic.conversation.advance import advance_conversation, next_time
from kinesic.conversation.events import ConversationEvent, Conversing, PeopleSeen, Person, VoiceActivity
from kinesic.conversation.state import ConversationState
from kinesic.conversation.turn_words import turn_words
from kinesic.conversation.wants import Look, ModeNotice, Want

ENGLISH = turn_words("en")
FRONT = (1.5, 0.0, 1.5)
TimedEvent = tuple[float, ConversationEvent]


@dataclass
class Record:
    """Modes and requested motions of one conversation."""

    wants: list[tuple[float, Want]] = field(default_factory=list)
    states: list[tuple[float, ConversationState]] = field(default_factory=list)

    def of(self, kind: type[Want]) -> list[tuple[float, Want]]:
        return [(time, want) for time, want in self.wants if isinstance(want, kind)]

    def modes(self) -> list[tuple[float, str]]:
        """Return the time and name of each new mode."""
        notices = [(time, want.mode) for time, want in self.wants if isinstance(want, ModeNotice)]
        return [pair for k, pair in enumerate(notices) if k == 0 or notices[k - 1][1] != pair[1]]

    def mode_at(self, time: float) -> str:
        return next(state.mode for at, state in reversed(self.states) if at <= time)

    def looking_fraction(self, begin: float, end: float) -> float:
        """Return the fraction of a time span with gaze at the person."""
        changes = [
            (begin, self._looks_at(begin)),
            *((t, self._looks_at(t)) for t, _ in self.of(Look) if begin < t < end),
        ]
        ends = [*(time for time, _ in changes[1:]), end]
        return sum(stop - start for (start, met), stop in zip(changes, ends, strict=True) if met) / (end - begin)

    def _looks_at(self, time: float) -> bool:
        look = next((want for at, want in reversed(self.of(Look)) if at <= time), None)
        return isinstance(look, Look) and look.place is not None and look.away == (0.0, 0.0)


def converse(
    events: Iterable[TimedEvent], until: float, *, seed: int = 0, words=ENGLISH, amount: float = 1.0
) -> Record:
    """Run a conversation with timed events from time 0 and record its output."""
    record, state, now = Record(), ConversationState(seed=seed), 0.0
    queue = sorted([(0.0, Conversing(on=True, amount=amount)), *events], key=lambda pair: pair[0])
    while True:
        due = next_time(state, now, words=words)
        event = queue.pop(0) if queue and queue[0][0] <= due else None
        now = due if event is None else event[0]
        if now > until:
            return record
        state, wants = advance_conversation(state, None if event is None else event[1], now, words=words)
        record.wants += [(now, want) for want in wants]
        record.states.append((now, state))


def present(until: float, *people: Person, begin: float = 0.0, period: float = 0.1) -> list[TimedEvent]:
    """Return periodic reports of people who do not move."""
    stood = people or (Person("p1", FRONT, looks=True),)
    return [(begin + period * k, PeopleSeen(stood)) for k in range(round((until - begin) / period))]


def says(begin: float, end: float, who: str | None = "p1") -> list[TimedEvent]:
    """Return the events of a voice that begins and ends."""
    return [(begin, VoiceActivity(active=True, who=who)), (end, VoiceActivity(active=False, who=who))]
