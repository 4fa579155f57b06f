"""Messages about gestures that need fingers, for robots without them."""

from collections.abc import Sequence

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.lexicon.form import GestureForm


def describe_missing_fingers(form: GestureForm, robot: Robot) -> str:
    """Describe the hand shapes or finger motion that a robot cannot make.

    The text is empty if the robot can make all of them.
    """
    return describe_missing_shapes(form.shapes, robot) or _describe_missing_motion(form, robot)


def describe_missing_shapes(requested_shapes: Sequence[str], robot: Robot) -> str:
    """Return a message about hand shapes that the robot cannot make.

    It is empty when the robot can make all of them.
    """
    shapes = [f'"{shape}"' for shape in lacking_shapes(requested_shapes, robot)]
    plural, singular = "s" * (len(shapes) > 1), "s" * (len(shapes) == 1)
    return f"hand shape{plural} {' and '.join(shapes)} need{singular} fingers" if shapes else ""


def _describe_missing_motion(form: GestureForm, robot: Robot) -> str:
    """Describe a finger motion that the robot cannot make.

    The text is empty if the robot has fingers, or the gesture has no finger motion.
    """
    has_fingers = any(robot.arm(side).fingers for side in robot.sides)
    return "" if form.fingers is None or has_fingers else f'finger motion "{form.fingers.name}" needs fingers'
