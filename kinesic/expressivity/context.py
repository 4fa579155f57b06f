"""Data shared by all behaviours of a performance or of a block.

Targets of gaze and pointing are names defined by the robot or the user, or three coordinates. The user's names come
from a file, `name = [x, y, z]` in metres, x forward, y left, z up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite
from pathlib import Path

from kinesic.bml.block import Behaviour, Block, Gesture, HandMode, Manner, Modality, find_modality
from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import KeyFrameFilling
from kinesic.body.config import read_toml, suggestion
from kinesic.body.robot import Robot
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.expressivity.idle import NO_IDLING, Idling
from kinesic.expressivity.lexicon.form import Match
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.resolve import resolve_styles
from kinesic.expressivity.style.style import Expressivity, Style, style_preset
from kinesic.expressivity.variation import NO_VARIATION, Deviation, Variation, deviations, needs_place


def read_targets(path: Path) -> Mapping[str, Floats]:
    """Read named gaze and pointing targets from a file, (3,) [m] each.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    return {name: sealed(point) for name, point in read_toml(path, dict[str, tuple[float, float, float]]).items()}


@dataclass(frozen=True, eq=False)
class Context:
    """Style, lexicon, robot, targets and options of a performance."""

    style: Style  # documents override the style; settings of the style override documents
    lexicon: Lexicon
    pace: Pace  # minimum and natural movement durations of the robot
    targets: Mapping[str, Floats] = field(
        default_factory=dict
    )  # named points (3,) [m], in addition to those of the robot
    gathering: KeyFrameFilling = "complex"  # method that fills parts without a key in a key frame
    idling: Idling = NO_IDLING  # idle motion in pauses
    variation: Variation = NO_VARIATION  # random variation between gestures


@dataclass(frozen=True, eq=False)
class BlockContext:
    """Block together with the context of its performance."""

    block: Block
    shared: Context  # data of all blocks of the performance
    busy_hands: Sequence[BusyHand] = ()  # hands that other blocks need at the same time

    @property
    def robot(self) -> Robot:
        """Robot that performs the block."""
        return self.shared.pace.robot

    @property
    def pace(self) -> Pace:
        """Minimum and natural movement durations of the robot."""
        return self.shared.pace

    @property
    def lexicon(self) -> Lexicon:
        """Gesture lexicon of the performance."""
        return self.shared.lexicon

    @cached_property
    def bearing(self) -> Style:
        """Style that sets standing posture, face and gaze of the block."""
        name = self.block.manners.get("gesture", Manner()).style
        if not name or any(setting.parameter == "posture" for setting in self.shared.style.settings):
            return self.shared.style
        return style_preset(name)

    @cached_property
    def targets(self) -> Mapping[str, Floats]:
        """World positions (3,) [m] of user and robot targets, by name."""
        return {**self.robot.targets, **self.shared.targets}

    @cached_property
    def styles(self) -> Mapping[str, Style]:
        """Resolved style by behaviour id, with random variation applied."""
        styles = resolve_styles(self.shared.style, self.block)
        return {**styles, **{id: deviation.style(styles[id]) for id, deviation in self.deviations.items()}}

    @cached_property
    def deviations(self) -> Mapping[str, Deviation]:
        """Random deviation by gesture id, empty without variation."""
        all_deviations = deviations(self.block, self.shared.variation)
        return {id: deviation.in_place if id in self._placed else deviation for id, deviation in all_deviations.items()}

    @cached_property
    def _placed(self) -> frozenset[str]:
        """Ids of gestures with hand positions that random variation must keep."""
        gestures = {
            behaviour.id: behaviour.action
            for behaviour in self.block.behaviours
            if isinstance(behaviour.action, Gesture)
        }
        matches = {id: self.lexicon.find(action.lexeme, action.mode) for id, action in gestures.items()}
        return frozenset(id for id, match in matches.items() if match is not None and needs_place(match.form))

    def find_gesture(self, behaviour: Behaviour, action: Gesture) -> Match | None:
        """Find the lexicon gesture of a behaviour, with random variation applied.

        Returns:
            None when the lexicon has no such gesture.
        """
        key = behaviour.id, action.lexeme, action.mode
        if key not in self._gestures:
            self._gestures[key] = self._find_gesture(behaviour, action)
        return self._gestures[key]

    @cached_property
    def _gestures(self) -> dict[tuple[str, str, HandMode], Match | None]:
        """Cache of the lexicon matches of the block's gestures.

        Each is looked up for durations, for hands, and in every planning iteration.
        """
        return {}

    def _find_gesture(self, behaviour: Behaviour, action: Gesture) -> Match | None:
        match, deviation = self.lexicon.find(action.lexeme, action.mode), self.deviations.get(behaviour.id)
        if match is None or deviation is None:
            return match
        return replace(match, form=deviation.form(match.form, self.robot))

    def manner(self, behaviour: Behaviour, modality: Modality | None = None) -> Expressivity:
        """Return a behaviour's expressivity for its modality, or for a given modality."""
        return self.styles[behaviour.id].of(modality or find_modality(behaviour.action) or "gesture")

    def find_target(self, text: str) -> Floats | None:
        """Return the position of a target by name or coordinates.

        Names ignore case. A part of an object, such as `user:l_wrist`, has the position of the whole unless it is a
        target itself.

        Returns:
            (3,) [m] in the world; None for an unknown target.
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
        """Return a message about an unknown target, with similar names."""
        return f'there is no target {text}{suggestion(text, list(self.targets))}, or "x y z" in metres'
