"""The context of a performance (style, lexicon, pace, targets) that all stages of expressivity share.

Targets of gaze and pointing are names that the robot or the user knows, or three coordinates. The user's names come
from a file, `name = [x, y, z]` in metres, x forward, y left, z up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite
from pathlib import Path

from kinesic.bml.block import Behaviour, Block, Gesture, HandMode, Modality, modality_of
from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import Gathering
from kinesic.body.config import read_toml, suggestion
from kinesic.body.robot import Robot
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.expressivity.idle import OFF, Idling
from kinesic.expressivity.lexicon.form import Match
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.resolve import resolve_styles
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.expressivity.variation import EXACT, Deviation, Variation, deviations, needs_place


def read_targets(path: Path) -> Mapping[str, Floats]:
    """Reads a targets file.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    return {name: sealed(point) for name, point in read_toml(path, dict[str, tuple[float, float, float]]).items()}


@dataclass(frozen=True, eq=False)
class Context:
    """What every block of a performance is performed with."""

    style: Style  # documents go over it, and its settings over them
    lexicon: Lexicon
    pace: Pace  # of the robot that performs
    targets: Mapping[str, Floats] = field(default_factory=dict)  # named points (3,) [m] beside the robot's own
    gathering: Gathering = "complex"  # how key frames are filled in which some parts have no key
    idling: Idling = OFF  # what fills pauses
    variation: Variation = EXACT  # how far gestures differ from one another


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
        asked = resolve_styles(self.shared.style, self.block)
        return {**asked, **{id: deviation.style(asked[id]) for id, deviation in self.deviations.items()}}

    @cached_property
    def deviations(self) -> Mapping[str, Deviation]:
        """Behaviour id -> how a gesture differs from what was asked; empty where none does."""
        found = deviations(self.block, self.shared.variation)
        return {id: each.in_place if id in self._placed else each for id, each in found.items()}

    @cached_property
    def _placed(self) -> frozenset[str]:
        """Ids of gestures whose hands must be where they are asked."""
        asked = {each.id: each.action for each in self.block.behaviours if isinstance(each.action, Gesture)}
        matches = {id: self.lexicon.find(action.lexeme, action.mode) for id, action in asked.items()}
        return frozenset(id for id, match in matches.items() if match is not None and needs_place(match.form))

    def find_gesture(self, behaviour: Behaviour, action: Gesture) -> Match | None:
        """Finds the gesture that a behaviour means, in its place; None when the lexicon has none."""
        asked = behaviour.id, action.lexeme, action.mode
        if asked not in self._gestures:
            self._gestures[asked] = self._find_gesture(behaviour, action)
        return self._gestures[asked]

    @cached_property
    def _gestures(self) -> dict[tuple[str, str, HandMode], Match | None]:
        """What was found: each is asked for by its durations, by its hands, and in every round of planning."""
        return {}

    def _find_gesture(self, behaviour: Behaviour, action: Gesture) -> Match | None:
        match, deviation = self.lexicon.find(action.lexeme, action.mode), self.deviations.get(behaviour.id)
        if match is None or deviation is None:
            return match
        return replace(match, form=deviation.form(match.form, self.robot))

    def manner(self, behaviour: Behaviour, modality: Modality | None = None) -> Expressivity:
        """Looks up the manner of one behaviour, in its own modality or in another."""
        return self.styles[behaviour.id].of(modality or modality_of(behaviour.action) or "gesture")

    def find_target(self, text: str) -> Floats | None:
        """Finds where a target is: its name in any case, or "x y z" in metres.

        A part of somebody, such as `user:l_wrist`, is where the whole is, unless it has a place of its own.

        Returns:
            (3,) [m] in the world; None when it is neither.
        """
        if text in self.targets:
            return self.targets[text]
        folded = {name.lower(): place for name, place in self.targets.items()}
        name = text.strip().lower()
        for whole in (name, name.partition(":")[0]):
            if whole in folded:
                return folded[whole]
        try:
            numbers = [float(part) for part in text.replace(",", " ").split()]
        except ValueError:
            return None
        return sealed(numbers) if len(numbers) == 3 and all(map(isfinite, numbers)) else None

    def unknown_target(self, text: str) -> str:
        """Says what is wrong with a target, and what would have worked."""
        return f'there is no target {text}{suggestion(text, list(self.targets))}, or "x y z" in metres'
