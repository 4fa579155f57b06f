from dataclasses import replace

from kinesic.controller.facts import Facts
from kinesic.expressivity.style import Style


def test_another_style_moves_the_same_robot(known: Facts):
    glad, sad = (replace(known, style=Style.load(style)) for style in ("joyful", "sad"))
    assert sad.limits is glad.limits
    assert sad.pace is glad.pace
