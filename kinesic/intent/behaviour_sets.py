"""The lexicon of intentions: which behaviours may show an intent, which of them must, and which exclude one another."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion

Channel = Literal["gesture", "head", "face", "gaze", "torso"]
CHANNELS: tuple[Channel, ...] = ("gesture", "head", "face", "gaze", "torso")
OWN = (CONFIGS / "intents" / "behaviours.toml", CONFIGS / "intents" / "fml.toml")
# Choices of a gaze that are no target.
DIRECTIONS = frozenset({"LEFT", "RIGHT", "UP", "DOWN", "UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT"})
NONE = "none"  # a choice that shows nothing


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
    """One way to show a signal."""

    lexeme: str  # in words of BML; `none`: it is not shown
    probability: float  # 0..1, of all choices of its signal together 1
    amount: float | None = None  # 0..1 as BML has it; None: as is usual
    repetition: int | None = None


@dataclass(frozen=True)
class Spell:
    """The rules by which a signal takes its turn in a sequence."""

    least: float  # [s] that it lasts
    most: float  # [s]
    early: float  # 0..1: how likely it is at the start of its intention
    late: float  # and at the end
    repeats: bool
    name: str
    excludes: frozenset[str]  # names of signals that are not shown beside it


@dataclass(frozen=True)
class Signal:
    """What one part of the body does."""

    id: str
    channel: Channel
    choices: tuple[Choice, ...]
    spell: Spell | None = None  # in a set whose signals follow one another


@dataclass(frozen=True)
class Implication:
    """A signal that another one demands, or forbids."""

    given: str  # id of the signal
    other: str  # id of the one that follows from it
    present: bool  # False: it is forbidden


@dataclass(frozen=True)
class BehaviourSet:
    """All that may show an intent."""

    name: str
    signals: tuple[Signal, ...]
    core: frozenset[str] = frozenset()  # ids of signals without which it is not shown
    implications: tuple[Implication, ...] = ()


@dataclass(frozen=True, eq=False)
class BehaviourSets:
    """Behaviour sets by the names of the intents that they show; `emotion-*` is for all emotions without one."""

    sets: Mapping[str, BehaviourSet]
    beside: "BehaviourSets | None" = None  # asked where these have nothing

    def find(self, name: str) -> BehaviourSet | None:
        """Finds the set of an intent: its own in any case of its letters, or that of its whole kind; None without."""
        found = self._find(name)
        return self.beside.find(name) if found is None and self.beside is not None else found

    def _find(self, name: str) -> BehaviourSet | None:
        lowered = name.lower()
        parts = lowered.split("-", self._longest + 1)
        wild = ("-".join([*parts[:count], "*"]) for count in range(min(len(parts) - 1, self._longest), 0, -1))
        return next((self._lowered[each] for each in (lowered, *wild) if each in self._lowered), None)

    @cached_property
    def _lowered(self) -> Mapping[str, BehaviourSet]:
        return {name.lower(): each for name, each in self.sets.items()}

    @cached_property
    def _longest(self) -> int:
        """Parts of the longest name."""
        return max((name.count("-") + 1 for name in self.sets), default=0)


@lru_cache(maxsize=2)
def own_sets() -> BehaviourSets:
    """Reads the sets that come with kinesic: of the functions that text has, and of FML-APML's intentions.

    Raises:
        ConfigError: a file is wrong.
    """
    tables: dict[str, _Set] = {}
    for path in OWN:
        tables |= read_toml(path, dict[str, _Set])
    return BehaviourSets({name: _behaviour_set(name, table, tables) for name, table in tables.items()})


def _behaviour_set(name: str, table: _Set, tables: Mapping[str, _Set]) -> BehaviourSet:
    if table.same:
        if table.same not in tables or tables[table.same].same:
            raise ConfigError(f"behaviour set {name} is the same as {table.same}{suggestion(table.same, list(tables))}")
        table = tables[table.same]
    signals = []
    for channel in CHANNELS:
        choices: list[str | _Choice] = getattr(table, channel)
        if choices:
            signals.append(Signal(channel, channel, _weighed(choices)))
    return BehaviourSet(name, tuple(signals), frozenset(table.core))


def _weighed(written: list[str | _Choice]) -> tuple[Choice, ...]:
    """Choices with their probabilities; those that say nothing share what the others leave."""
    choices = [_Choice(each) if isinstance(each, str) else each for each in written]
    said = sum(each.probability or 0.0 for each in choices)
    silent = sum(each.probability is None for each in choices)
    rest = max(0.0, 1.0 - said) / silent if silent else 0.0
    return tuple(
        Choice(each.name, rest if each.probability is None else each.probability, each.amount, each.repetition)
        for each in choices
    )
