from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.naturalness.story import longest, measure_story
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.idle import Idling

TOLD = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <speech id="s" start="1"><text>Once there was a <sync id="h"/>large garden in the middle of a town, and nobody
    thought of it at all, until one day the gate was open.</text></speech>
  <gesture id="g" lexeme="large" stroke="s:h" relax="s:h+2"/>
</bml>"""


@pytest.fixture(scope="module")
def known():
    return set_up()


def test_without_what_goes_on_unasked_a_teller_is_frozen_and_with_it_alive(known):
    still, alive = (measure_story(plan(TOLD, replace(known, idling=Idling(amount, 1)))) for amount in (0.0, 1.0))
    assert still.still_trunk > 0.4 > 0.1 > alive.still_trunk
    assert still.still_head > 0.4 > 0.1 > alive.still_head
    assert still.longest_all > 0.5 > 0.3 > alive.longest_all
    assert len(still.holds) == len(alive.holds) == 2
    assert max(still.holds) < 0.001 < min(alive.holds)
    assert not still.missed
    assert 0.0 < still.aside < 1.0


def test_what_is_dropped_and_what_comes_late_is_missed(known):
    crowded = TOLD.replace("</bml>", '<gesture id="h" lexeme="house" stroke="s:h+0.05"/></bml>')
    assert set(measure_story(plan(crowded, known)).missed) & {"g", "h"}


@pytest.mark.parametrize(("flags", "most"), [([], 0), ([0, 0], 0), ([1, 1, 0, 1], 2), ([0, 1, 1, 1], 3)])
def test_the_longest_run_is_counted(flags, most):
    assert longest(np.array(flags, dtype=np.bool_)) == most
