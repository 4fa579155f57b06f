"""Tests of the search for contradicting time constraints."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.negative_cycles import Edge, find_contradictions

A, B, C = (Point("b", name, "start") for name in "abc")


def test_consistent_time_constraints_have_no_contradictions() -> None:
    assert find_contradictions([]) == []
    assert find_contradictions([Edge(A, B, 1.0), Edge(B, A, -1.0), Edge(B, C, 0.0), Edge(C, A, -1.5)]) == []


def test_contradicting_time_constraints_are_returned_as_an_ordered_cycle() -> None:
    (loop,) = find_contradictions([Edge(A, C, 5.0), Edge(A, B, 1.0), Edge(B, C, 1.0), Edge(C, A, -1.9)])
    assert sum(edge.gap for edge in loop) > 0
    assert all(edge.head == after.tail for edge, after in zip(loop, [*loop[1:], loop[0]], strict=True))


def test_sync_point_constrained_to_follow_itself_is_a_contradiction() -> None:
    assert find_contradictions([Edge(A, A, 1.0)]) == [[Edge(A, A, 1.0)]]
    assert find_contradictions([Edge(A, A, 0.0)]) == []


def test_rounding_errors_of_times_are_not_contradictions() -> None:
    assert find_contradictions([Edge(A, B, 0.1), Edge(B, C, 0.2), Edge(C, A, -0.3)]) == []


edges_ = st.lists(
    st.tuples(st.integers(0, 4), st.integers(0, 4), st.integers(-3, 3)).map(
        lambda row: Edge(Point("b", str(row[0]), "start"), Point("b", str(row[1]), "start"), 0.5 * row[2])
    ),
    max_size=10,
)


@given(edges_)
@settings(max_examples=300)
def test_contradicting_loop_is_found_if_and_only_if_one_exists(edges) -> None:
    longest = np.full((5, 5), -np.inf)
    for edge in edges:
        row, column = int(edge.tail.behaviour), int(edge.head.behaviour)
        longest[row, column] = max(longest[row, column], edge.gap)
    for middle in range(5):
        longest = np.maximum(longest, longest[:, [middle]] + longest[[middle], :])
    loops = find_contradictions(edges)
    assert bool(loops) is bool((np.diag(longest) > 0.0).any())
    for loop in loops:
        assert sum(edge.gap for edge in loop) > 0.0
        assert all(edge in edges for edge in loop)
        assert all(edge.head == after.tail for edge, after in zip(loop, [*loop[1:], loop[0]], strict=True))
