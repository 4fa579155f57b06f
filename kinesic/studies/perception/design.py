"""What a study shows and asks (thesis 4.4 and Table 4.2): 96 stimuli that count, and 32 more to confuse.

Every face is shown with wrinkles and without, faint and strong, still and moving; a participant sees a quarter of all,
as many of the upper face as of the lower and as many moving as still.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from types import MappingProxyType
from typing import Literal, get_args

from kinesic.body.choices import Variant

Region = Literal["upper", "lower"]
Strength = Literal["low", "high"]
Presentation = Literal["animation", "image"]

INTENSITIES: Mapping[Strength, float] = MappingProxyType({"low": 0.4, "high": 1.0})
PER_CELL = 8  # stimuli of one region and presentation that a participant sees (Table 4.2)
POINTS = 5  # of a Likert scale


@dataclass(frozen=True)
class FacialAction:
    """Something that a face does."""

    name: str  # numbers of its action units with + between them; "none"
    region: Region  # whose questions are asked
    label: str = ""  # as participants read it; empty: only shown to confuse
    units: Mapping[str, float] = field(default_factory=dict)  # action unit -> intensity of the strong one

    @property
    def asked(self) -> bool:
        """Whether participants are asked for it."""
        return self.label != ""


ACTIONS = (
    FacialAction("1+2", "upper", "The eyebrows are raised in a half circle", {"1": 1.0, "2": 1.0}),
    FacialAction("4", "upper", "The face is frowning", {"4": 1.0}),
    FacialAction("1+4", "upper", "The eyebrows are raised obliquely", {"1": 1.0, "4": 0.6}),
    FacialAction("6", "lower", "The cheeks are raised", {"6": 1.0}),
    FacialAction("12", "lower", "The lips are extended, corners up", {"12": 1.0}),
    FacialAction("20", "lower", "The lips are extended straight", {"20": 1.0}),
)
CONFUSERS = (
    (FacialAction("5", "upper", units={"5": 1.0}), ("low", "high")),
    (FacialAction("7", "upper", units={"7": 1.0}), ("high",)),
    (FacialAction("none", "upper"), ("high",)),
    (FacialAction("26", "lower", units={"26": 1.0}), ("low", "high")),
    (FacialAction("15", "lower", units={"15": 1.0}), ("high",)),
    (FacialAction("none", "lower"), ("high",)),
)
LABELS: Mapping[str, str] = MappingProxyType({action.name: action.label for action in ACTIONS})


@dataclass(frozen=True)
class Stimulus:
    """One face that a participant looks at, once."""

    action: FacialAction
    agent: Variant
    strength: Strength
    wrinkles: bool
    presentation: Presentation

    @property
    def id(self) -> str:
        """Names its file and its answers, such as `female-4-high-wrinkled-animation`."""
        surface = "wrinkled" if self.wrinkles else "smooth"
        action = f"{self.action.name}-{self.action.region}" if self.action.name == "none" else self.action.name
        return "-".join((self.agent, action, self.strength, surface, self.presentation))

    @property
    def units(self) -> Mapping[str, float]:
        """Action units at the peak, 0..1."""
        share = INTENSITIES[self.strength]
        return {unit: share * full for unit, full in self.action.units.items()}


def stimuli() -> tuple[Stimulus, ...]:
    """Lists 128: 2 agents x 6 actions x 2 strengths x 2 (wrinkles or not) x 2 presentations, and 32 that confuse."""
    agents, moving = get_args(Variant), get_args(Presentation)
    counted = (
        Stimulus(action, agent, strength, wrinkles, presentation)
        for action, agent, strength, wrinkles, presentation in product(
            ACTIONS, agents, INTENSITIES, (True, False), moving
        )
    )
    confusing = (
        Stimulus(action, agent, strength, True, presentation)
        for action, strengths in CONFUSERS
        for agent, strength, presentation in product(agents, get_args(Strength), moving)
        if strength in strengths
    )
    return (*counted, *confusing)
