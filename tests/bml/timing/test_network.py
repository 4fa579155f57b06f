"""Tests of networks of sync points and their constraints."""

import random
from itertools import pairwise

import pytest

from kinesic.bml.block import Block
from kinesic.bml.parse import parse
from kinesic.bml.timing.constraints import Point, find_equalities
from kinesic.bml.timing.negative_cycles import Edge
from kinesic.bml.timing.network import Distance, Network, Potentials, ReferenceResolver, SyncChain
from kinesic.body.utterance import Utterance

A, B, C, D = (Point("b", name, "start") for name in "abcd")
BLOCK_START = Point("b", "bml", "start")
BEAT_TEMPLATE = '<gesture id="{}" lexeme="BEAT" {}/>'  # beat with a given id and attributes
EXTERNAL_TIMES = {("other", "x", "end"): 2.5}  # [s] time of a sync point of another block


def block_of(inside: str) -> Block:
    return parse(f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{inside}</bml>')


def resolved(inside: str) -> tuple[ReferenceResolver, Network]:
    block = block_of(inside)
    utterances = {b.id: Utterance(1.5, {"m": 0.5, "n": 0.25}) for b in block.behaviours if b.type == "speech"}
    resolver = ReferenceResolver(block, {b.id: b for b in block.behaviours}, utterances, EXTERNAL_TIMES, {})
    attribute_equalities = [equality for equality in find_equalities(block) if equality.owner is not None]
    return resolver, resolver.build_network(attribute_equalities, list(block.constraints))


def distances(network: Network) -> list[tuple[Point, Point, float]]:
    return [(edge.late, edge.early, edge.gap) for edge in network.distances]


def test_unlinked_sync_point_forms_a_set_of_one_point() -> None:
    assert Potentials().find(A) == (A, 0.0)


def test_fixed_time_offsets_between_sync_points_add_up_over_a_chain_of_links() -> None:
    points = [Point("b", f"x{k}", "start") for k in range(12)]
    for seed in range(20):
        drawn, potentials = random.Random(seed), Potentials()
        time = {point: drawn.randrange(-40, 40) / 4 for point in points}
        pairs = [(points[k], points[drawn.randrange(k)]) for k in range(1, len(points))]
        drawn.shuffle(pairs)
        for late, early in (drawn.sample(pair, 2) for pair in pairs):
            potentials.join(late, early, time[late] - time[early])
        roots = {potentials.find(point)[0] for point in points}
        assert len(roots) == 1
        root = roots.pop()
        for _ in range(2):  # the second time with compressed paths
            assert {point: potentials.find(point)[1] for point in points} == {p: time[p] - time[root] for p in points}


def test_first_of_two_contradicting_distances_between_sync_points_is_kept() -> None:
    potentials = Potentials()
    potentials.join(B, A, 1.0)
    potentials.join(B, A, 5.0)
    assert potentials.find(B)[1] - potentials.find(A)[1] == 1.0


def test_sets_of_linked_sync_points_are_ordered_by_first_use() -> None:
    potentials = Potentials()
    potentials.join(D, A, 2.0)
    potentials.find(B)
    potentials.join(C, D, 1.0)
    first, second = potentials.list_sets()
    assert {point: gap - first[A] for point, gap in first.items()} == {A: 0.0, D: 2.0, C: 3.0}
    assert second == {B: 0.0}


def test_behaviour_lasts_at_least_a_microsecond_unless_fixed() -> None:
    """Check the minimum that reveals behaviours waiting for each other."""
    _, free = resolved(BEAT_TEMPLATE.format("g", ""))
    (chain,) = free.chains
    first, last = chain.points[0], chain.points[-1]
    assert Edge(first, last, 1e-6, "g") in free.edges()
    assert sum(edge.gap for edge in free.edges()) == 1e-6
    _, fixed = resolved(BEAT_TEMPLATE.format("g", 'start="1" end="1"'))
    assert all(edge.gap in (0.0, 1.0, -1.0) for edge in fixed.edges())


def test_fixed_sync_time_becomes_two_opposite_time_constraints() -> None:
    _, network = resolved(BEAT_TEMPLATE.format("g", 'start="2"'))
    start = Point("b", "g", "start")
    edges, points = network.edges(), network.chains[0].points
    assert edges[: len(points) - 1] == [Edge(a, b, 0.0, "g") for a, b in pairwise(points)]
    assert edges[-2:] == [Edge(BLOCK_START, start, 2.0, "g"), Edge(start, BLOCK_START, -2.0, "g")]


@pytest.mark.parametrize(("gap", "clashes"), [(0.5, 0), (0.0, 0), (-0.5e-9, 0), (-2e-9, 1), (-0.5, 1)])
def test_sync_points_fixed_in_reverse_order_conflict(gap: float, clashes: int) -> None:
    _, network = resolved(BEAT_TEMPLATE.format("g", ""))
    points = network.chains[0].points
    tied = Network(BLOCK_START, network.chains, (Distance(points[4], points[2], gap, None),), ())
    loops = tied.find_order_conflicts()
    assert len(loops) == clashes
    for loop in loops:
        assert loop == [Edge(points[2], points[4], 0.0, "g"), Edge(points[4], points[2], pytest.approx(-gap), "g")]


def test_first_pair_of_fixed_sync_points_in_reverse_order_is_returned() -> None:
    _, network = resolved(BEAT_TEMPLATE.format("g", ""))
    points = network.chains[0].points
    tied = tuple(Distance(points[k], points[0], 4.0 - k / 2, None) for k in (2, 4, 5))
    (loop,) = Network(BLOCK_START, network.chains, tied, ()).find_order_conflicts()
    assert (loop[0].tail, loop[0].head, loop[1].gap) == (points[2], points[4], 1.0)


def test_speech_marks_and_end_have_fixed_distances_from_the_speech_start() -> None:
    _, network = resolved('<speech id="s"><text>a<sync id="m"/>b<sync id="n"/>c<sync id="lost"/></text></speech>')
    point = {name: Point("b", "s", name) for name in ("start", "n", "m", "end")}
    assert network.chains[0].points == tuple(point.values())
    assert network.chains[0].is_rigid
    assert distances(network) == [
        (point["n"], point["start"], 0.25),
        (point["m"], point["start"], 0.5),
        (point["end"], point["start"], 1.5),
    ]


def test_references_to_behaviours_and_times_become_time_distances() -> None:
    resolver, network = resolved(
        BEAT_TEMPLATE.format("g", 'start="h:end+0.5" stroke="3" end="other:x:end-1"') + BEAT_TEMPLATE.format("h", "")
    )
    point = {name: Point("b", "g", name) for name in ("start", "stroke", "end")}
    assert distances(network) == [
        (point["start"], Point("b", "h", "end"), 0.5),
        (point["stroke"], BLOCK_START, 3.0),
        (point["end"], BLOCK_START, 1.5),
    ]
    assert [edge.owner for edge in network.distances] == ["g"] * 3
    assert resolver.unresolved == []


def test_after_constraint_becomes_edges_from_the_earlier_sync_point() -> None:
    order = '<constraint><after ref="g:stroke+1"><sync ref="h:start+3"/><sync ref="h:end"/></after></constraint>'
    _, network = resolved(BEAT_TEMPLATE.format("g", "") + BEAT_TEMPLATE.format("h", "") + order)
    stroke, start, end = Point("b", "g", "stroke"), Point("b", "h", "start"), Point("b", "h", "end")
    assert network.orders == (Edge(stroke, start, -2.0), Edge(stroke, end, 1.0))


def test_all_behaviours_end_before_a_block_end_that_one_of_them_references() -> None:
    end = Point("b", "bml", "end")
    pair = BEAT_TEMPLATE.format("g", "") + BEAT_TEMPLATE.format("h", "")
    assert resolved(pair)[1].orders == ()
    for inside in (
        BEAT_TEMPLATE.format("z", 'end="bml:end"') + pair,
        pair + '<constraint><before ref="bml:end"><sync ref="g:start"/></before></constraint>',
        pair + '<constraint><after ref="bml:end"><sync ref="g:start"/></after></constraint>',
    ):
        _, network = resolved(inside)
        assert {edge.tail for edge in network.orders if edge.head == end} >= {c.points[-1] for c in network.chains}


@pytest.mark.parametrize(
    ("syncs", "reason"),
    [
        ('stroke="h:nope"', "h has no sync point 'nope', but start, ready, strokeStart, stroke, strokeEnd, relax, end"),
        ('stroke="other:x:start"', "other:x:start is unknown"),
        ('stroke="bml:stroke"', "the block has no sync point 'stroke', only start and end"),
    ],
)
def test_unresolved_sync_references_are_listed_and_omitted(syncs: str, reason: str) -> None:
    resolver, network = resolved(BEAT_TEMPLATE.format("g", syncs) + BEAT_TEMPLATE.format("h", ""))
    assert network.distances == ()
    (unresolved,) = resolver.unresolved
    assert (unresolved.culprit, unresolved.reason) == ("g", reason)


def test_unconstrained_gesture_has_variable_phase_durations() -> None:
    chain = SyncChain(block_of(BEAT_TEMPLATE.format("g", "")).behaviours[0], (A, B))
    assert not chain.is_rigid
