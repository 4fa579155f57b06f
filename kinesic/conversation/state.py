"""Immutable state of a conversation."""

from dataclasses import dataclass, field, replace
from math import inf

from kinesic.conversation.events import Place
from kinesic.conversation.people import Company, Roles, TrackedPerson
from kinesic.conversation.wants import STRAIGHT_DIRECTION, Direction, Look, Mode

EYE_HEIGHT = 1.5  # [m] default height of the robot's eyes


@dataclass(frozen=True)
class PersonVoice:
    """Voice activity and recognised words of a person."""

    active: bool = False
    who: str | None = None  # id of the person; None: unknown
    began: float = -inf  # [s] start of the current or last stretch of voice
    resumed: float = -inf  # [s] latest reported start of a voice; an end before it is outdated
    ended: float = -inf  # [s] end of the last stretch; meaningless while active
    text: str = ""  # recognised words of the turn
    clauses: int = 0  # number of recognised clause ends since a nod was last considered
    predicted: float | None = None  # probability that the turn passes to the robot; None: not predicted

    def duration(self, now: float) -> float:
        """Return the duration of the current or last stretch of voice [s]."""
        return (now if self.active else self.ended) - self.began


@dataclass(frozen=True)
class OwnSpeech:
    """Speech of the robot."""

    active: bool = False
    began: float = -inf  # [s] start of the speech
    ends: float = inf  # [s] expected end; infinity: unknown


@dataclass(frozen=True)
class GazeSpell:
    """Period in which the robot looks at a person, or away."""

    averted: bool = False  # whether the robot looks away from the person
    away: Direction = STRAIGHT_DIRECTION  # [deg] direction relative to the person
    head_fraction: float = 0.0  # fraction of `away` that the head performs; the eyes perform the rest
    until: float = inf  # [s] end of the period


@dataclass(frozen=True)
class ConversationState:
    """State of a conversation between two events."""

    on: bool = False  # whether the conversation runs
    amount: float = 1.0  # amount of movement, 0..1
    eyes: Place = (0.0, 0.0, EYE_HEIGHT)  # [m] position of the robot's eyes
    seed: int = 0  # seed of the random numbers
    draws: int = 0  # random numbers drawn so far
    mode: Mode = "off"
    since: float = 0.0  # [s] start of the mode
    company: Company = field(default_factory=Company)
    addressee: str | None = None  # id of the person with whom the robot exchanged the last turn
    voice: PersonVoice = field(default_factory=PersonVoice)
    listened: bool = False  # whether the robot has listened to the person's current turn
    thinks: bool = False  # whether a client prepares an answer
    fillers: int = 0  # number of fillers since thinking began
    speech: OwnSpeech = field(default_factory=OwnSpeech)
    gaze: GazeSpell = field(default_factory=GazeSpell)
    look: Look | None = None  # last requested gaze
    look_time: float = -inf  # [s] time of the last gaze request
    met_since: float = -inf  # [s] start of the robot's current look at the person
    nods: tuple[float, ...] = ()  # [s] times of the nods of the last minute
    nod_considered: float = -inf  # [s] end of the stretch of voice after which a nod was considered
    lonely_since: float = -inf  # [s] time at which the last person left, or the conversation began

    @property
    def partner(self) -> TrackedPerson | None:
        """Attended person, or None."""
        return self.company.find(self.company.focus)

    @property
    def roles(self) -> Roles:
        """Speaker and addressee among the people."""
        return Roles(self.voice.who if self.voice.active else None, self.addressee)

    def draw(self) -> tuple[float, "ConversationState"]:
        """Return a random number in [0, 1) and the next state."""
        return _uniform(self.seed, self.draws), replace(self, draws=self.draws + 1)

    def vary(self, spread: tuple[float, float]) -> tuple[float, "ConversationState"]:
        """Return a random value around a mean, and the next state.

        Args:
            spread: mean of the values, and half of their range.
        """
        number, after = self.draw()
        return spread[0] + spread[1] * (2.0 * number - 1.0), after


def _uniform(seed: int, count: int) -> float:
    """Return a number in [0, 1) by the generator SplitMix64."""
    mask = (1 << 64) - 1
    z = ((seed + 1) * 0x9E3779B97F4A7C15 * (count + 1) + count) & mask
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
    return ((z ^ (z >> 31)) >> 11) / (1 << 53)
