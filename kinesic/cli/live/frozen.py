"""Snapshot of the planning configuration taken when a server starts.

Worker processes read no robot, style, targets or lexicon files again.
"""

from dataclasses import dataclass, replace
from typing import Self

from kinesic.body.robot import Robot
from kinesic.cli.options import Planning
from kinesic.expressivity.lexicon.lexicon import Lexicon, read_part
from kinesic.expressivity.lexicon.toml_file import LexiconPart
from kinesic.expressivity.style.style import Style
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.session.options import PlanningOptions
from kinesic.session.setup import set_up


@dataclass(frozen=True, eq=False)
class FrozenPlanning:
    """Planning options with all files loaded, unaffected by later file changes.

    Picklable for worker processes.
    """

    robot: Robot
    style: Style
    gestures: LexiconPart | None  # gestures of the user's lexicon
    options: PlanningOptions  # all other options

    @classmethod
    def of(cls, planning: Planning) -> Self:
        """Load the files that the planning options name.

        Raises:
            ConfigError: a file is missing or invalid.
        """
        lexicon_path = planning.options.get("lexicon")
        setup = planning.set_up()
        options: PlanningOptions = {**planning.options, "targets": setup.targets, "lexicon": None}
        gestures = None if lexicon_path is None else read_part(lexicon_path)
        robot = load_robot(planning.robot)  # A fresh robot has no cached data, so its pickle is small.
        return cls(robot, Style.load(planning.style), gestures, options)

    def set_up(self) -> Setup:
        """Build the planning setup from the snapshot."""
        setup = set_up(self.robot, style=self.style, **self.options)
        lexicon = setup.lexicon if self.gestures is None else Lexicon.load(self.gestures)
        lexicon.read_all()  # Clients do not wait for the files later.
        return replace(setup, lexicon=lexicon)
