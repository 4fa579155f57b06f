"""Chosen behaviours of a text, and omitted ones with their reasons."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.intent.behaviour_sets import Channel
from kinesic.intent.intents import Intent


@dataclass(frozen=True)
class ChosenBehaviour:
    """Behaviour that shows an intent."""

    channel: Channel
    lexeme: str
    intent: Intent
    amount: float | None = None
    repetition: int | None = None
    manner: Mapping[str, float] = field(default_factory=dict)  # expressivity parameters, -1..1
    begin: str = ""  # start of a gesture as a BML reference; empty: its natural start
    captured: bool = False  # whether the lexeme is a captured gesture, which also points at a target

    @property
    def form(self) -> str:
        """Lexeme, with the hand if the intent chooses it."""
        return name_form(self.lexeme, self.intent)


def name_form(lexeme: str, intent: Intent) -> str:
    """Return a gesture's lexeme, with the hand if its intent chooses one.

    The same gesture of the other hand is another form, and no repetition.
    """
    return f"{lexeme} {intent.hand}" if intent.hand else lexeme


@dataclass(frozen=True)
class Omission:
    """Omitted signal or intent, with the reason."""

    intent: Intent
    channel: Channel | None  # channel of the omitted signal; None: the whole intent is omitted
    why: str


@dataclass(frozen=True)
class Selection:
    """Chosen behaviours in the order of their strokes, and omissions with reasons."""

    behaviours: tuple[ChosenBehaviour, ...]
    omissions: tuple[Omission, ...]
    replaced: tuple[ChosenBehaviour, ...] = ()  # earlier behaviours that the chosen behaviours replace
    warnings: tuple[str, ...] = ()  # parts of the text that are neither spoken nor performed


@dataclass(frozen=True)
class Earlier:
    """Behaviours, gesture counts and duration of the preceding words."""

    fixed: tuple[ChosenBehaviour, ...] = ()  # behaviours that have begun or ended
    free: tuple[ChosenBehaviour, ...] = ()  # behaviours that have not begun and may be replaced
    strokes: int = 0  # number of gestures before the first word
    pictures: int = 0  # number of these gestures that are not beats
    seconds: float = 0.0  # [s] duration of speech before the first word


NO_EARLIER_BEHAVIOURS = Earlier()  # state at the beginning of a text
