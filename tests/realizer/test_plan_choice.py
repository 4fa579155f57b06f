"""Choice between quick and full plans of large blocks."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from kinesic.realizer import realizer as module
from kinesic.realizer.realizer import prepare_block

from .small_blocks import small_block


@pytest.fixture
def planners(monkeypatch):
    """Record full and quick plans."""
    calls = []

    def plan(name):
        def take(*given, **options):
            calls.append((name, given, options))
            return name

        return take

    for name in ("plan_block", "plan_quickly"):
        monkeypatch.setattr(module, name, plan(name))
    return calls


def timed(*times: tuple[float, float], inside: str | None = None, **options):
    """Return a request of nods with start and end [s]."""
    nods = "".join(f'<head id="n{k}" lexeme="NOD"/>' for k in range(len(times))) if inside is None else inside
    request = small_block("b", inside=nods, **options).prepared.request
    items = [
        SimpleNamespace(behaviour=behaviour, times={"start": start, "end": end})
        for behaviour, (start, end) in zip(request.block.behaviours, times, strict=True)
    ]
    return replace(request, timeline=SimpleNamespace(timed=items))


@pytest.mark.parametrize(
    ("times", "is_quick"),
    [
        ([], False),
        ([(0.0, 1.0)] * 4, False),
        ([(0.0, 1.0)] * 5, True),
        ([(1.0, 2.0), (11.0, 21.0)], False),
        ([(1.0, 2.0), (11.0, 21.1)], True),
        ([(-30.0, -29.0)], False),
    ],
)
def test_block_of_more_than_four_behaviours_or_20_s_gets_a_quick_plan_first(known, planners, times, is_quick):
    request = timed(*times)
    prepared = prepare_block(request, known)
    ((name, given, options),) = planners
    assert given == (request.block, known)
    assert name == prepared.plan == ("plan_quickly" if is_quick else "plan_block")
    assert prepared.is_provisional is is_quick
    assert prepared.request is request
    assert options["busy_hands"] == ()
    if not is_quick:
        assert options["timeline"] is None
        assert options["conditioned"].keywords == {"lead_in": 0.0}


def test_speech_and_face_behaviours_do_not_cause_a_quick_plan(known, planners):
    faces = "".join(f'<faceLexeme id="f{k}" lexeme="RAISE_BROWS"/>' for k in range(5))
    request = timed(*[(0.0, 99.0)] * 6, inside=faces + '<speech id="s"><text>Yes</text></speech>')
    assert not prepare_block(request, known).is_provisional


def test_block_whose_speech_has_started_gets_a_full_plan_with_the_same_speech(known, planners):
    request = replace(timed(*[(0.0, 99.0)] * 9), is_decided=True)
    prepared = prepare_block(request, known, is_scheduled=True)
    ((name, given, options),) = planners
    assert (name, given, prepared.is_provisional) == ("plan_block", (request.block, known), False)
    assert options["utterances"] is request.utterances
    assert "timeline" not in options
    assert options["conditioned"].keywords == {"lead_in": 0.0}


def test_planning_of_a_scheduled_block_reuses_its_timeline(known, planners):
    request = timed((0.0, 1.0))
    prepare_block(request, known, is_scheduled=True)
    assert planners[0][2]["timeline"] is request.timeline
