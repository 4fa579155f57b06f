"""Tests of unconstrained and infeasible ends of blocks and speech."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import BmlError, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

from .conftest import SPEECH_XML, at, gesture

Timing = Callable[[str], Timeline]


@pytest.mark.parametrize(
    "syncs",
    [
        'end="bml:end"',
        'end="bml:end-1"',
        'end="after(bml:end-1)"',
        'start="after(bml:end-10)"',
        'ready="bml:end-10"',
        'start="before(bml:end-3)"',
    ],
)
def test_gesture_tied_to_an_unfixed_block_end_has_its_natural_times(timed: Timing, syncs: str) -> None:
    timeline, natural = timed(gesture("g", syncs)), timed(gesture("g"))
    assert timeline.timed[0].times == pytest.approx(natural.timed[0].times, abs=1e-6)
    assert timeline.notices == ()


def test_behaviours_tied_to_the_block_end_keep_their_natural_duration(timed: Timing) -> None:
    timeline = timed(
        gesture("a", 'end="bml:end"') + gesture("c", 'end="bml:end-2"') + gesture("d", 'start="c:start-3"')
    )
    natural = timed(gesture("g")).end
    lengths = [at(timeline, f"{name}:end") - at(timeline, f"{name}:start") for name in "acd"]
    assert lengths == pytest.approx([natural] * 3)
    assert at(timeline, "c:end") == pytest.approx(at(timeline, "a:end") - 2.0)
    assert timeline.start == 0.0


def test_block_without_a_fixed_end_ends_with_its_last_constrained_behaviour(timed: Timing) -> None:
    timeline = timed(gesture("g", 'ready="bml:end-10"') + gesture("f", 'end="8"'))
    assert (at(timeline, "f:end"), at(timeline, "g:ready")) == pytest.approx((8.0, -2.0))


def test_synchronize_constraint_can_fix_the_block_end_time(timed: Timing) -> None:
    ends = '<constraint><synchronize><sync ref="bml:end"/><sync ref="3"/></synchronize></constraint>'
    assert at(timed(gesture("g", 'end="bml:end"') + ends), "g:end") == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("syncs", "lost"),
    [
        ('start="0" end="9"', ["end"]),
        ('start="0" end="0.2"', ["end"]),
        ('end="1" start="5"', ["end"]),
        ('start="1" m="1" end="9"', ["end"]),
        ('start="1" end="nobody:else:end"', ["end"]),
        ('start="1" end="g:stroke"', ["end"]),
    ],
)
def test_infeasible_end_time_of_a_speech_is_ignored(timed: Timing, syncs: str, lost: list[str]) -> None:
    timeline = timed(SPEECH_XML.replace('id="s"', f'id="s" {syncs}') + gesture("g", 'stroke="2" strokeEnd="2.5"'))
    assert [timed.behaviour.id for timed in timeline.timed] == ["s", "g"]
    assert at(timeline, "s:end") - at(timeline, "s:start") == pytest.approx(1.5)
    assert at(timeline, "s:start") == float(syncs.partition('start="')[2].partition('"')[0])
    texts = [n.text for n in timeline.notices if n.id == "b:s" and "is spoken without its" in n.text]
    assert [text.partition(":")[0] for text in texts] == [f"'s' is spoken without its {sync}" for sync in lost]


def test_infeasible_sync_times_of_a_draft_speech_are_ignored_with_notices() -> None:
    block = parse(
        f"<bml>{SPEECH_XML}</bml>".replace('id="s"', 'id="s" start="0" ready=".1" stroke=".1" relax=".2" end=".2"')
    )
    timeline = schedule(block, {"s": Utterance(1.5, {"m": 0.6})}, {})
    assert (at(timeline, "s:start"), at(timeline, "s:end"), timeline.dropped) == (0.0, 1.5, ())
    assert sorted(n.text.partition(":")[0] for n in timeline.notices) == [
        f"'s' is spoken without its {sync}" for sync in ("end", "ready", "relax", "stroke")
    ]


def test_constraint_infeasible_for_a_speech_is_ignored(timed: Timing) -> None:
    constraint = '<constraint><synchronize><sync ref="s:m"/><sync ref="s:end"/>{}</synchronize></constraint>'
    timeline = timed(SPEECH_XML + constraint.format(""))
    assert (at(timeline, "s:end"), timeline.dropped, [n.id for n in timeline.notices]) == (1.5, (), ["b"])
    required = SPEECH_XML.replace("<speech", '<required><speech start="0" end="9"').replace(
        "</speech>", "</speech></required>"
    )
    with pytest.raises(BmlError, match="required speech 's'"):
        timed(required)


@pytest.mark.parametrize("requested", ['start="before(5)" end="bml:end"', 'stroke="before(5)" end="bml:end"'])
def test_unconstrained_block_end_is_late_enough_to_avoid_negative_start_times(timed: Timing, requested: str) -> None:
    timeline = timed(gesture("g", requested) + gesture("f", 'start="before(5)" end="bml:end"'))
    assert min(at(timeline, "g:start"), at(timeline, "f:start")) == pytest.approx(0.0, abs=1e-6)
    assert at(timeline, "g:end") == pytest.approx(at(timeline, "f:end"))
