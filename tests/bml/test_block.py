"""What a document may say of expressivity, and how long a timeline lasts."""

from kinesic.bml.block import RANGES, Behaviour, Block, Head, Place, TimedBehaviour, Timeline, refusal


def test_openness_is_a_fraction_and_every_other_parameter_an_extent_to_both_sides():
    assert RANGES["openness"] == (0.0, 1.0)
    others = {name: ends for name, ends in RANGES.items() if name != "openness"}
    assert others.keys() == {"spatial", "temporal", "fluidity", "power", "tension", "repetition", "activation"}
    assert set(others.values()) == {(-1.0, 1.0)}


def timeline(*times: dict[str, float]) -> Timeline:
    behaviours = [Behaviour(f"h{k}", "head", Head("NOD"), Place(1, 1)) for k in range(len(times))]
    timed = tuple(TimedBehaviour(behaviour, own) for behaviour, own in zip(behaviours, times, strict=True))
    return Timeline(Block("b", tuple(behaviours)), timed)


def test_a_timeline_lasts_from_its_first_to_its_last_sync_point_and_holds_the_time_0():
    both = timeline({"start": -0.5, "end": 1.0}, {"start": 0.2, "end": 3.0})
    assert (both.start, both.end) == (-0.5, 3.0)
    later = timeline({"start": 1.0, "end": 2.0})
    assert (later.start, later.end) == (0.0, 2.0)
    assert (timeline().start, timeline().end) == (0.0, 0.0)
    early = timeline({"start": -3.0, "end": -2.0})
    assert (early.start, early.end) == (-3.0, 0.0)


def test_a_refusal_says_where_what_and_what_would_have_worked():
    assert str(refusal("a.bml", Place(3, 7), "no end", "give one")) == "a.bml:3:7: no end; give one"
