"""What blocks are performed with, handed on as one from natural durations to key frames, gaze and face."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from kinesic.bml.block import Behaviour, Block, Modality, modality_of
from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.gather import Gathering
from kinesic.expressivity.hands.coarticulation import Engaged
from kinesic.expressivity.idle import OFF, Idling
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.resolve import resolve_styles
from kinesic.expressivity.style.style import Expressivity, Style


@dataclass(frozen=True, eq=False)
class Context:
    """What every block of a performance is performed with."""

    style: Style  # documents go over it, and its settings over them
    lexicon: Lexicon
    pace: Pace  # of the robot that performs
    targets: Mapping[str, Floats] = field(default_factory=dict)  # named points (3,) [m] beside the robot's own
    gathering: Gathering = "complex"  # how key frames are filled in which some parts have no key
    idling: Idling = OFF  # what fills pauses


@dataclass(frozen=True, eq=False)
class BlockContext:
    """One block and what it is performed with."""

    block: Block
    shared: Context  # with all other blocks
    engaged: Sequence[Engaged] = ()  # hands that other blocks need meanwhile

    @property
    def robot(self) -> Robot:
        """Who performs."""
        return self.shared.pace.robot

    @property
    def pace(self) -> Pace:
        """How fast the robot moves."""
        return self.shared.pace

    @property
    def lexicon(self) -> Lexicon:
        """The gestures that are known."""
        return self.shared.lexicon

    @cached_property
    def targets(self) -> Mapping[str, Floats]:
        """All named points (3,) [m] in the world, the robot's own included."""
        return {**self.robot.targets, **self.shared.targets}

    @cached_property
    def styles(self) -> Mapping[str, Style]:
        """Behaviour id -> its own style, resolved once for all stages."""
        return resolve_styles(self.shared.style, self.block)

    def manner(self, behaviour: Behaviour, modality: Modality | None = None) -> Expressivity:
        """The manner of one behaviour, in its own modality or in another."""
        return self.styles[behaviour.id].of(modality or modality_of(behaviour.action) or "gesture")
