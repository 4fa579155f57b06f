"""What planning is given beside the text."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal

from kinesic.bml.block import Dialect
from kinesic.body.arrays import Floats
from kinesic.body.choices import Gathering, GrammarName
from kinesic.body.dynamics import Distances, Dynamics, Load
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.body.utterance import Voice
from kinesic.expressivity.context import Context
from kinesic.expressivity.idle import OFF, Idling
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import EXACT, Variation


@dataclass(frozen=True)
class IntentionFiles:
    """Files of Greta that say how intentions are shown; None: kinesic's own way."""

    lexicon: Path | None = None  # of intentions
    baseline: Path | None = None  # expressivity of the agent
    qualifiers: Path | None = None  # what intentions change of it


@dataclass(frozen=True, eq=False)
class Setup:
    """The robot, its manner and all else that planning is given beside a document; planning changes none of it."""

    robot: Robot
    style: Style
    lexicon: Lexicon
    voice: Voice
    dynamics: Dynamics
    distances: Distances
    targets: Mapping[str, Floats] = field(default_factory=dict)  # named points (3,) [m] beside the robot's own
    dialect: Dialect | Literal["auto"] = "auto"  # how documents are read
    gathering: Gathering = "complex"  # how key frames are filled
    idling: Idling = OFF  # what goes on unasked
    variation: Variation = EXACT  # how far gestures differ from one another
    pause: float = 0.0  # [s] longest pause before a word that waits for the body, where documents do not say
    character: str | None = None  # which of several characters the robot is; None: the one that a block is for
    language: str = "en"  # of plain text
    grammar: GrammarName = "rules"  # who finds its phrases and clauses
    intentions: IntentionFiles = IntentionFiles()  # how they are shown

    @cached_property
    def limits(self) -> Limits:
        """The motion limits of every hinge of the robot."""
        return _limits(self.robot, self.dynamics.load)

    @cached_property
    def pace(self) -> Pace:
        """How fast the robot moves, at ease and at best."""
        return _pace(self.robot, self.limits)

    @cached_property
    def context(self) -> Context:
        """What every block is performed with."""
        return Context(self.style, self.lexicon, self.pace, self.targets, self.gathering, self.idling, self.variation)


# Setups that differ in style or voice alone share what was worked out for the robot.


@lru_cache(maxsize=8)
def _limits(robot: Robot, load: Load) -> Limits:
    return Limits.of(robot, load)


@lru_cache(maxsize=8)
def _pace(robot: Robot, limits: Limits) -> Pace:
    return Pace(robot, limits)
