"""Ends that nothing bounds, and ends that cannot be: times stay natural, and speech is said all the same."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import BmlError, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

from .conftest import SPEECH, at, gesture

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
def test_a_block_that_nothing_bounds_is_closed_at_its_natural_end(timed: Timing, syncs: str) -> None:
    found, natural = timed(gesture("g", syncs)), timed(gesture("g"))
    assert found.timed[0].times == pytest.approx(natural.timed[0].times, abs=1e-6)
    assert found.notices == ()


def test_behaviours_that_hang_on_the_end_together_take_their_natural_time(timed: Timing) -> None:
    found = timed(gesture("a", 'end="bml:end"') + gesture("c", 'end="bml:end-2"') + gesture("d", 'start="c:start-3"'))
    natural = timed(gesture("g")).end
    lengths = [at(found, f"{name}:end") - at(found, f"{name}:start") for name in "acd"]
    assert lengths == pytest.approx([natural] * 3)
    assert at(found, "c:end") == pytest.approx(at(found, "a:end") - 2.0)
    assert found.start == 0.0


def test_the_end_of_a_block_is_that_of_what_others_bound(timed: Timing) -> None:
    found = timed(gesture("g", 'ready="bml:end-10"') + gesture("f", 'end="8"'))
    assert (at(found, "f:end"), at(found, "g:ready")) == pytest.approx((8.0, -2.0))


def test_a_constraint_may_say_when_the_block_ends(timed: Timing) -> None:
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
def test_a_speech_is_said_without_an_end_that_cannot_be(timed: Timing, syncs: str, lost: list[str]) -> None:
    found = timed(SPEECH.replace('id="s"', f'id="s" {syncs}') + gesture("g", 'stroke="2" strokeEnd="2.5"'))
    assert [timed.behaviour.id for timed in found.timed] == ["s", "g"]
    assert at(found, "s:end") - at(found, "s:start") == pytest.approx(1.5)
    assert at(found, "s:start") == float(syncs.partition('start="')[2].partition('"')[0])
    texts = [n.text for n in found.notices if n.id == "b:s" and "is said without its" in n.text]
    assert [text.partition(":")[0] for text in texts] == [f"'s' is said without its {sync}" for sync in lost]


def test_a_draft_speech_with_times_for_all_its_points_is_said() -> None:
    block = parse(
        f"<bml>{SPEECH}</bml>".replace('id="s"', 'id="s" start="0" ready=".1" stroke=".1" relax=".2" end=".2"')
    )
    found = schedule(block, {"s": Utterance(1.5, {"m": 0.6})}, {})
    assert (at(found, "s:start"), at(found, "s:end"), found.dropped) == (0.0, 1.5, ())
    assert sorted(n.text.partition(":")[0] for n in found.notices) == [
        f"'s' is said without its {sync}" for sync in ("end", "ready", "relax", "stroke")
    ]


def test_a_constraint_that_a_speech_cannot_meet_is_passed_over(timed: Timing) -> None:
    constraint = '<constraint><synchronize><sync ref="s:m"/><sync ref="s:end"/>{}</synchronize></constraint>'
    found = timed(SPEECH + constraint.format(""))
    assert (at(found, "s:end"), found.dropped, [n.id for n in found.notices]) == (1.5, (), ["b"])
    required = SPEECH.replace("<speech", '<required><speech start="0" end="9"').replace(
        "</speech>", "</speech></required>"
    )
    with pytest.raises(BmlError, match="required speech 's'"):
        timed(required)


@pytest.mark.parametrize("asked", ['start="before(5)" end="bml:end"', 'stroke="before(5)" end="bml:end"'])
def test_a_block_whose_end_nothing_else_bounds_ends_so_late_that_nothing_begins_before_it(
    timed: Timing, asked: str
) -> None:
    found = timed(gesture("g", asked) + gesture("f", 'start="before(5)" end="bml:end"'))
    assert min(at(found, "g:start"), at(found, "f:start")) == pytest.approx(0.0, abs=1e-6)
    assert at(found, "g:end") == pytest.approx(at(found, "f:end"))
