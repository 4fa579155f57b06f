"""HTML of plans, performances, robots, gestures and styles for notebooks."""

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.form import GestureForm, Match
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.report.display.gesture import gesture_html, match_html
from kinesic.report.display.plan import performance_html, plan_html
from kinesic.report.display.robot import robot_html
from kinesic.report.display.style import style_html
from kinesic.report.run import Performance


def make_html(shown: object) -> str:
    """Return the HTML of an object for notebooks.

    Raises:
        TypeError: objects of this type have no HTML.
    """
    match shown:
        case Performance():
            return performance_html(shown)
        case Plan():
            return plan_html(shown)
        case Robot():
            return robot_html(shown)
        case Style():
            return style_html(shown)
        case Match():
            return match_html(shown)
        case GestureForm():
            return gesture_html(shown)
        case _:
            raise TypeError(f"{type(shown).__name__} has no HTML; see kinesic.report.display")
