"""Tests of blocks with many behaviours that cannot be scheduled."""

from collections.abc import Callable

from kinesic.bml.block import Timeline

from .conftest import gesture

Timing = Callable[[str], Timeline]


def test_two_hundred_infeasible_behaviours_are_dropped_and_the_feasible_one_kept(timed: Timing) -> None:
    timeline = timed("".join(gesture(f"g{i}", 'start="2" end="1"') for i in range(200)) + gesture("other"))
    assert (len(timeline.dropped), [x.behaviour.id for x in timeline.timed]) == (200, ["other"])


def test_chain_of_600_behaviours_that_refer_to_an_infeasible_one_is_dropped(timed: Timing) -> None:
    chain = "".join(gesture(f"g{i}", f'start="g{i - 1}:start"') for i in range(600, 0, -1))
    assert len(timed(chain + gesture("g0", 'start="2" end="1"')).dropped) == 601
