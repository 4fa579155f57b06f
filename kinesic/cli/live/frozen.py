"""Planning as it was when a server began: its processes read no file of robot, style, targets or lexicon again."""

from dataclasses import dataclass, replace
from typing import Self

from kinesic.body.robot import Robot
from kinesic.cli.options import Planning
from kinesic.controller.options import PlanningOptions
from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.lexicon import Lexicon, read_part
from kinesic.expressivity.lexicon.toml_file import LexiconPart
from kinesic.expressivity.style.style import Style
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup


@dataclass(frozen=True, eq=False)
class FrozenPlanning:
    """What the options of planning named, whatever becomes of the files; picklable."""

    robot: Robot
    style: Style
    gestures: LexiconPart | None  # of the user
    options: PlanningOptions  # all others

    @classmethod
    def of(cls, planning: Planning) -> Self:
        """Reads the files that options name.

        Raises:
            ConfigError: something is missing or wrong.
        """
        named = planning.options.get("lexicon")
        setup = planning.set_up()
        options: PlanningOptions = {**planning.options, "targets": setup.targets, "lexicon": None}
        gestures = None if named is None else read_part(named)
        robot = load_robot(planning.robot)  # anew: one of which nothing is worked out yet is small
        return cls(robot, Style.load(planning.style), gestures, options)

    def set_up(self) -> Setup:
        """Makes what planning needs."""
        known = set_up(self.robot, style=self.style, **self.options)
        lexicon = known.lexicon if self.gestures is None else Lexicon.load(self.gestures)
        lexicon.read_all()  # who asks a server does not wait for it
        return replace(known, lexicon=lexicon)
