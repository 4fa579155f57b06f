from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.naturalness.story import longest_run, measure_story
from kinesic.expressivity.idle import Idling
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

STORY = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <speech id="s" start="1"><text>Once there was a <sync id="h"/>large garden in the middle of a town, and nobody
    thought of it at all, until one day the gate was open.</text></speech>
  <gesture id="g" lexeme="large" stroke="s:h" relax="s:h+2"/>
</bml>"""


@pytest.fixture(scope="module")
def setup():
    return set_up()


def test_default_idle_motion_keeps_head_and_trunk_moving_during_a_story(setup):
    still, alive = (measure_story(plan(STORY, replace(setup, idling=Idling(amount, 1)))) for amount in (0.0, 1.0))
    assert still.still_trunk > 0.4 > 0.1 > alive.still_trunk
    assert still.still_head > 0.4 > 0.2 > alive.still_head
    assert still.longest_all > 0.5 > alive.longest_all
    assert len(still.holds) == len(alive.holds) == 2
    assert max(still.holds) < 0.001 < min(alive.holds)
    assert not still.missed
    assert 0.0 < still.aside < 1.0


def test_one_of_two_overlapping_story_strokes_counts_as_missed(setup):
    overlapping = STORY.replace("</bml>", '<gesture id="h" lexeme="house" stroke="s:h+0.05"/></bml>')
    assert set(measure_story(plan(overlapping, setup)).missed) & {"g", "h"}


@pytest.mark.parametrize(("flags", "longest"), [([], 0), ([0, 0], 0), ([1, 1, 0, 1], 2), ([0, 1, 1, 1], 3)])
def test_longest_run_of_true_values_is_counted(flags, longest):
    assert longest_run(np.array(flags, dtype=np.bool_)) == longest
