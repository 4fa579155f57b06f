"""Contradictions among distances."""

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.negative_cycles import Edge, contradictions

A, B, C = (Point("b", name, "start") for name in "abc")


def test_consistent_edges_have_none() -> None:
    assert contradictions([]) == []
    assert contradictions([Edge(A, B, 1.0), Edge(B, A, -1.0), Edge(B, C, 0.0), Edge(C, A, -1.5)]) == []


def test_a_loop_is_found_in_order() -> None:
    (loop,) = contradictions([Edge(A, C, 5.0), Edge(A, B, 1.0), Edge(B, C, 1.0), Edge(C, A, -1.9)])
    assert sum(edge.gap for edge in loop) > 0
    assert all(edge.head == after.tail for edge, after in zip(loop, [*loop[1:], loop[0]], strict=True))


def test_a_point_after_itself() -> None:
    assert contradictions([Edge(A, A, 1.0)]) == [[Edge(A, A, 1.0)]]
    assert contradictions([Edge(A, A, 0.0)]) == []


def test_rounding_is_no_contradiction() -> None:
    assert contradictions([Edge(A, B, 0.1), Edge(B, C, 0.2), Edge(C, A, -0.3)]) == []
