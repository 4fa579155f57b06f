"""Adaptation of gestures to a robot with one arm.

Gestures are swapped, reduced to that arm, or left out.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from kinesic.bml.block import HandMode
from kinesic.body.robot import SIDE_NAMES, SIDES, Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import in_mode, mirror_form

OTHER_ARM_TOUCHES = ("hand", "forearm", "upper_arm")  # touched parts of the other arm


@dataclass(frozen=True, eq=False)
class PresentForm:
    """Form of a gesture for the arms that a robot has."""

    form: GestureForm
    swapped: str = ""  # message about a gesture that the other arm performs
    reduced: str = ""  # message about the missing half of a two-handed gesture
    dropped: str = ""  # reason why the gesture cannot be performed


def fit_form(form: GestureForm, robot: Robot, mode: HandMode = "unspecified") -> PresentForm:
    """Adapt a gesture to the arms of a robot.

    The existing arm performs the mirror image of the gesture of a missing arm, and its own part of a gesture of both
    arms. A gesture that touches the missing arm or hand is left out.
    """
    touches_arm = any(pose.touch in OTHER_ARM_TOUCHES for key in form.keys for pose in key.hands.values())
    if len(robot.sides) == len(SIDES) or (form.sides <= set(robot.sides) and not touches_arm):
        return PresentForm(form)
    missing = f"robot {robot.name} has no {name_missing_arm(robot)} arm"
    (side,) = robot.sides
    if touches_arm:
        return PresentForm(form, dropped=f"{missing}, which {form.id} touches")
    if len(form.sides) == 1:
        swapped = "" if mode == "unspecified" else f"{missing}; the {SIDE_NAMES[side]} arm performs {form.id}"
        return PresentForm(mirror_form(form), swapped=swapped)
    one = in_mode(form, "left" if side == "l" else "right")
    return PresentForm(one, reduced=f"{missing}; the {SIDE_NAMES[side]} arm performs its part of {form.id}")


def name_missing_arm(robot: Robot) -> str:
    """Return `left` or `right` for a missing arm, or an empty text."""
    return "".join(SIDE_NAMES[side] for side in SIDES if side not in robot.sides)


def describe_missing_arm(mode: HandMode, robot: Robot) -> str:
    """Describe a requested but missing arm, or return an empty text."""
    side = name_missing_arm(robot)
    if not side or mode not in ("both", side):
        return ""
    return f"robot {robot.name} has no {side} arm; the other arm performs it"


def select_present(sides: Iterable[Side], robot: Robot) -> tuple[Side, ...]:
    """Return the given sides with an arm, or the only arm's side."""
    return tuple(side for side in sides if side in robot.sides) or robot.sides
