"""Behaviours that show each intent: alternatives, required and exclusive signals."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion

Channel = Literal["gesture", "head", "face", "gaze", "torso"]
CHANNEL_NAMES: tuple[Channel, ...] = ("gesture", "head", "face", "gaze", "torso")  # body channels
SET_FILES = (CONFIGS / "intents" / "behaviours.toml", CONFIGS / "intents" / "fml.toml")
# Lexemes of a gaze that are directions instead of targets.
GAZE_DIRECTIONS = frozenset({"LEFT", "RIGHT", "UP", "DOWN", "UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT"})
NO_SIGNAL = "none"  # lexeme of a choice that shows nothing


class _Choice(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    name: str
    probability: float | None = None
    amount: float | None = None
    repetition: int | None = None


class _Set(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    gesture: list[str | _Choice] = []
    head: list[str | _Choice] = []
    face: list[str | _Choice] = []
    gaze: list[str | _Choice] = []
    torso: list[str | _Choice] = []
    core: list[Channel] = []
    same: str = ""


@dataclass(frozen=True)
class Choice:
    """One alternative lexeme of a signal, with its probability."""

    lexeme: str  # lexeme in BML; `none`: the signal is not shown
    probability: float  # 0..1; the probabilities of all choices of a signal add up to 1
    amount: float | None = None  # 0..1 amount of the movement, as in BML; None: default amount
    repetition: int | None = None


@dataclass(frozen=True)
class Spell:
    """Duration, probability and exclusions of a signal within a sequence."""

    least: float  # [s] minimum duration
    most: float  # [s] maximum duration
    early: float  # 0..1 probability at the start of the intention
    late: float  # 0..1 probability at the end of the intention
    repeats: bool  # whether the signal may be shown again
    name: str
    excludes: frozenset[str]  # names of signals that are not shown together with this signal


@dataclass(frozen=True)
class Signal:
    """Behaviour of one body channel, with its alternatives."""

    id: str
    channel: Channel
    choices: tuple[Choice, ...]
    spell: Spell | None = None  # duration and probability of a signal in a sequence; None: not in a sequence


@dataclass(frozen=True)
class Implication:
    """Rule: if one signal is shown, another is required or forbidden."""

    given: str  # id of the signal that is the condition
    other: str  # id of the implied signal
    present: bool  # whether the implied signal is required; False: forbidden


@dataclass(frozen=True)
class BehaviourSet:
    """All signals that may show an intent."""

    name: str
    signals: tuple[Signal, ...]
    core: frozenset[str] = frozenset()  # ids of required signals
    implications: tuple[Implication, ...] = ()


@dataclass(frozen=True, eq=False)
class BehaviourSets:
    """Behaviour sets by the names of their intents.

    `emotion-*` applies to all emotions without a set.
    """

    sets: Mapping[str, BehaviourSet]
    fallback: "BehaviourSets | None" = None  # sets used for intents that are missing here

    def find(self, name: str) -> BehaviourSet | None:
        """Find the behaviour set of an intent, ignoring case.

        The set of the intent's category is used if it has none of its own.

        Returns:
            None without either set.
        """
        behaviour_set = self._find(name)
        return self.fallback.find(name) if behaviour_set is None and self.fallback is not None else behaviour_set

    @property
    def names(self) -> frozenset[str]:
        """Names of all behaviour sets, also those of the fallback."""
        return frozenset(self.sets) | (self.fallback.names if self.fallback is not None else frozenset())

    def _find(self, name: str) -> BehaviourSet | None:
        lowered = name.lower()
        parts = lowered.split("-", self._longest + 1)
        wild = ("-".join([*parts[:count], "*"]) for count in range(min(len(parts) - 1, self._longest), 0, -1))
        return next((self._lowered[key] for key in (lowered, *wild) if key in self._lowered), None)

    @cached_property
    def _lowered(self) -> Mapping[str, BehaviourSet]:
        return {name.lower(): behaviour_set for name, behaviour_set in self.sets.items()}

    @cached_property
    def _longest(self) -> int:
        """Largest number of hyphenated parts in the names of behaviour sets."""
        return max((name.count("-") + 1 for name in self.sets), default=0)


@lru_cache(maxsize=2)
def builtin_sets() -> BehaviourSets:
    """Read the built-in behaviour sets for text and FML-APML intentions.

    Raises:
        ConfigError: a file is invalid.
    """
    tables: dict[str, _Set] = {}
    for path in SET_FILES:
        tables |= read_toml(path, dict[str, _Set])
    return BehaviourSets({name: _behaviour_set(name, table, tables) for name, table in tables.items()})


def _behaviour_set(name: str, table: _Set, tables: Mapping[str, _Set]) -> BehaviourSet:
    if table.same:
        if table.same not in tables or tables[table.same].same:
            raise ConfigError(f"behaviour set {name} is the same as {table.same}{suggestion(table.same, list(tables))}")
        table = tables[table.same]
    signals = []
    for channel in CHANNEL_NAMES:
        choices: list[str | _Choice] = getattr(table, channel)
        if choices:
            signals.append(Signal(channel, channel, _fill_probabilities(choices)))
    return BehaviourSet(name, tuple(signals), frozenset(table.core))


def _fill_probabilities(written: list[str | _Choice]) -> tuple[Choice, ...]:
    """Fill in the missing probabilities of a signal's alternatives.

    Choices without a probability divide the remainder equally.
    """
    choices = [_Choice(choice) if isinstance(choice, str) else choice for choice in written]
    total = sum(choice.probability or 0.0 for choice in choices)
    unspecified = sum(choice.probability is None for choice in choices)
    rest = max(0.0, 1.0 - total) / unspecified if unspecified else 0.0
    return tuple(
        Choice(
            choice.name, rest if choice.probability is None else choice.probability, choice.amount, choice.repetition
        )
        for choice in choices
    )
