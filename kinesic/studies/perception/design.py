"""Design of the face study (thesis 4.4, Table 4.2).

96 counted and 32 distractor stimuli.

Every face is shown with and without wrinkles, weak and strong, still and moving. A participant sees a quarter of all
stimuli, with equal numbers of upper and lower faces and of moving and still faces.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from itertools import product
from types import MappingProxyType
from typing import Literal, get_args

from kinesic.body.choices import Variant

Region = Literal["upper", "lower"]
Strength = Literal["low", "high"]
Presentation = Literal["animation", "image"]

STRENGTH_INTENSITIES: Mapping[Strength, float] = MappingProxyType({"low": 0.4, "high": 1.0})
STIMULI_PER_CELL = 8  # stimuli per participant, region and presentation (thesis Table 4.2)
CODE_LENGTH = 8  # hexadecimal digits of a stimulus's name for participants
LIKERT_POINTS = 5  # number of points of a Likert scale


@dataclass(frozen=True)
class FacialAction:
    """Facial action with its action units and its text for participants."""

    name: str  # numbers of its action units joined by +; "none"
    region: Region  # region of its questions
    label: str = ""  # text for participants; empty for a distractor
    units: Mapping[str, float] = field(default_factory=dict)  # action unit -> intensity of the strong version


FACIAL_ACTIONS = (
    FacialAction("1+2", "upper", "The eyebrows are raised in a half circle", {"1": 1.0, "2": 1.0}),
    FacialAction("4", "upper", "The face is frowning", {"4": 1.0}),
    FacialAction("1+4", "upper", "The eyebrows are raised obliquely", {"1": 1.0, "4": 0.6}),
    FacialAction("6", "lower", "The cheeks are raised", {"6": 1.0}),
    FacialAction("12", "lower", "The lips are extended, corners up", {"12": 1.0}),
    FacialAction("20", "lower", "The lips are extended straight", {"20": 1.0}),
)
DISTRACTOR_ACTIONS = (
    (FacialAction("5", "upper", units={"5": 1.0}), ("low", "high")),
    (FacialAction("7", "upper", units={"7": 1.0}), ("high",)),
    (FacialAction("none", "upper"), ("high",)),
    (FacialAction("26", "lower", units={"26": 1.0}), ("low", "high")),
    (FacialAction("15", "lower", units={"15": 1.0}), ("high",)),
    (FacialAction("none", "lower"), ("high",)),
)


@dataclass(frozen=True)
class Stimulus:
    """One face picture or film that a participant sees once."""

    action: FacialAction
    agent: Variant
    strength: Strength
    wrinkles: bool
    presentation: Presentation

    @property
    def id(self) -> str:
        """Name of the stimulus, such as `female-4-high-wrinkled-animation`."""
        surface = "wrinkled" if self.wrinkles else "smooth"
        action = f"{self.action.name}-{self.action.region}" if self.action.name == "none" else self.action.name
        return "-".join((self.agent, action, self.strength, surface, self.presentation))

    @property
    def code(self) -> str:
        """Name of the stimulus for participants (`face-1b2c3d4e`), without its condition."""
        return f"face-{sha256(self.id.encode()).hexdigest()[:CODE_LENGTH]}"

    @property
    def units(self) -> Mapping[str, float]:
        """Action units of the face at the expression's peak, 0..1."""
        intensity = STRENGTH_INTENSITIES[self.strength]
        return {unit: intensity * full for unit, full in self.action.units.items()}


def list_stimuli() -> tuple[Stimulus, ...]:
    """List all 128 stimuli of the face study.

    They are 2 agents x 6 actions x 2 strengths x 2 (with or without wrinkles) x 2 presentations, and 32 distractors.
    """
    agents, moving = get_args(Variant), get_args(Presentation)
    counted = (
        Stimulus(action, agent, strength, wrinkles, presentation)
        for action, agent, strength, wrinkles, presentation in product(
            FACIAL_ACTIONS, agents, STRENGTH_INTENSITIES, (True, False), moving
        )
    )
    distractors = (
        Stimulus(action, agent, strength, True, presentation)
        for action, strengths in DISTRACTOR_ACTIONS
        for agent, strength, presentation in product(agents, get_args(Strength), moving)
        if strength in strengths
    )
    return (*counted, *distractors)
