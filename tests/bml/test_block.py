"""Tests of expressivity ranges and timelines."""

from kinesic.bml.block import (
    EXPRESSIVITY_RANGES,
    Behaviour,
    Block,
    Head,
    Place,
    TimedBehaviour,
    Timeline,
    document_error,
)


def test_openness_ranges_from_0_to_1_and_other_parameters_from_minus_1_to_1():
    assert EXPRESSIVITY_RANGES["openness"] == (0.0, 1.0)
    ranges = {name: ends for name, ends in EXPRESSIVITY_RANGES.items() if name != "openness"}
    assert ranges.keys() == {"spatial", "temporal", "fluidity", "power", "tension", "repetition", "activation"}
    assert set(ranges.values()) == {(-1.0, 1.0)}


def timeline(*times: dict[str, float]) -> Timeline:
    behaviours = [Behaviour(f"h{k}", "head", Head("NOD"), Place(1, 1)) for k in range(len(times))]
    timed = tuple(
        TimedBehaviour(behaviour, sync_times) for behaviour, sync_times in zip(behaviours, times, strict=True)
    )
    return Timeline(Block("b", tuple(behaviours)), timed)


def test_timeline_of_a_block_spans_all_sync_points_and_zero():
    both = timeline({"start": -0.5, "end": 1.0}, {"start": 0.2, "end": 3.0})
    assert (both.start, both.end) == (-0.5, 3.0)
    later = timeline({"start": 1.0, "end": 2.0})
    assert (later.start, later.end) == (0.0, 2.0)
    assert (timeline().start, timeline().end) == (0.0, 0.0)
    early = timeline({"start": -3.0, "end": -2.0})
    assert (early.start, early.end) == (-3.0, 0.0)


def test_document_error_names_line_column_problem_and_remedy():
    assert str(document_error("a.bml", Place(3, 7), "no end", "give one")) == "a.bml:3:7: no end; give one"
