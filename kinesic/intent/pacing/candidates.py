"""Signals of intents that may be chosen."""

from dataclasses import dataclass

from kinesic.intent.behaviour_sets import Choice, Signal
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.intents import Intent


@dataclass(frozen=True)
class Candidate:
    """Signal that may be chosen to show an intent."""

    intent: Intent
    signal: Signal
    weight: float  # certainty times preference, with a bonus for core signals
    choices: tuple[Choice, ...]
    substitutes: tuple[Choice, ...] = ()  # gestures of the same meaning, shown if all `choices` were shown recently
    earlier: ChosenBehaviour | None = None  # earlier behaviour that the candidate repeats; None: a new behaviour
