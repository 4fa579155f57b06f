from dataclasses import replace

from kinesic.controller.facts import Facts
from kinesic.expressivity.style import Style


def test_another_style_moves_the_same_robot(known: Facts):
    sad = replace(known, style=Style.load("sad"))
    assert sad.limits is known.limits
    assert sad.pace is known.pace
