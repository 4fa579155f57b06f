from dataclasses import replace

from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup


def test_changing_the_style_keeps_the_cached_motion_limits(known: Setup):
    glad, sad = (replace(known, style=Style.load(style)) for style in ("joyful", "sad"))
    assert sad.limits is glad.limits
    assert sad.pace is glad.pace
