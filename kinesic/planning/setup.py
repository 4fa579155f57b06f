"""Planning setup: everything that planning needs besides the document."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal

from kinesic.bml.block import Dialect
from kinesic.body.arrays import Floats
from kinesic.body.choices import GesturePreference, GrammarName, KeyFrameFilling
from kinesic.body.dynamics import Distances, Dynamics, Impacts, Load
from kinesic.body.impact_policy import ImpactPolicy
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.body.utterance import Voice
from kinesic.expressivity.context import Context
from kinesic.expressivity.idle import NO_IDLING, Idling
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.prosody import Prosody
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import NO_VARIATION, Variation

MAX_BODY_WEIGHT = 1.5  # upper bound of the style's whole-body weight, a factor on secondary motion


@dataclass(frozen=True)
class IntentionFiles:
    """Paths of Greta's intention files, by default kinesic's own."""

    lexicon: Path | None = None  # lexicon of intentions
    baseline: Path | None = None  # expressivity of the agent
    qualifiers: Path | None = None  # changes of the baseline by intentions


@dataclass(frozen=True, eq=False)
class Setup:
    """Robot, style, lexicon, voice and options used for planning."""

    robot: Robot
    style: Style
    lexicon: Lexicon
    voice: Voice
    dynamics: Dynamics
    distances: Distances
    targets: Mapping[str, Floats] = field(default_factory=dict)  # named points (3,) [m] in addition to the robot's own
    dialect: Dialect | Literal["auto"] = "auto"  # dialect of the documents
    gathering: KeyFrameFilling = "complex"  # filling of key frames in which some parts have no key
    idling: Idling = NO_IDLING  # idle motion
    prosody: float = 0.0  # amount of brows, nods, blinks and lip opening by prosody
    variation: Variation = NO_VARIATION  # variation between gestures
    pause: float = 0.0  # [s] default of the longest pause before a word that waits for the body
    character: str | None = None  # character of the robot in documents for several robots; None: the block's character
    language: str = "en"  # language of plain text
    grammar: GrammarName = "rules"  # parser of phrases and clauses of plain text
    intentions: IntentionFiles = IntentionFiles()  # behaviours of intentions
    recordings: Path | None = None  # folder of the recordings of documents that are no files; None: not played
    preference: GesturePreference = "lexicon"  # gestures preferred for beats, offers and deictics of a text
    unstyled: Robot | None = None  # the robot without the posture of a style; None: documents cannot change the posture
    impacts: Impacts | None = None  # contacts with people; None: not computed
    policy: ImpactPolicy | None = None  # limits of contacts with people; None: no limits
    shared_limits: Limits | None = None  # limits of the same body in another rest posture; None: computed

    def __repr__(self) -> str:
        return f"<setup: {self.robot}, {self.style}, {self.lexicon!r}>"

    @cached_property
    def limits(self) -> Limits:
        """Motion limits of every hinge."""
        return self.shared_limits or _limits(self.robot, self.dynamics.load)

    @cached_property
    def pace(self) -> Pace:
        """Rest-to-rest durations of the robot's movements within its servo limits."""
        return _pace(self.robot, self.limits)

    @property
    def style_prosody(self) -> Prosody:
        """Amount of prosody-driven motion, scaled by the style, with its seed."""
        return Prosody(self.prosody * min(self.style.whole_body, MAX_BODY_WEIGHT), self.idling.seed)

    @cached_property
    def context(self) -> Context:
        """Expressivity settings common to all blocks."""
        return Context(self.style, self.lexicon, self.pace, self.targets, self.gathering, self.idling, self.variation)


# Setups that differ only in style or voice use the same cached limits and pace.


@lru_cache(maxsize=8)
def _limits(robot: Robot, load: Load) -> Limits:
    return Limits.of(robot, load)


@lru_cache(maxsize=8)
def _pace(robot: Robot, limits: Limits) -> Pace:
    return Pace(robot, limits)
