"""Motion graph of captured gestures, and the search in it."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.capture.graph_search import LEAVE_COST, REPETITION_TIME, GestureRequest, search_path
from kinesic.capture.motion_graph import MotionGraph, build_graph
from kinesic.expressivity.lexicon.captured_gesture import GestureCapture, MotionTable

from ..expressivity.lexicon.captured_clips import MARKERS, motion


def capture(id: str, shift: float = 0.0, height: float = 0.3, **markers: float) -> GestureCapture:
    """Return a captured swing of the right hand, shifted outward [arm lengths]."""
    table = MotionTable(file=f"{id}.npz", hand="right", markers={**MARKERS, **markers})
    return GestureCapture(id, motion(shift=shift, height=height), table)


@pytest.fixture(scope="module")
def graph() -> MotionGraph:
    """Build the graph of three similar clips and one distant clip."""
    return build_graph([capture("a"), capture("b", 0.01), capture("c", 0.02, 0.32), capture("far", 2.0)])


def test_motion_graph_nodes_are_the_gesture_phases_of_all_clips(graph):
    phases = [node.phase for node in graph.nodes if node.capture == 0]
    assert phases == ["preparation", "stroke", "hold", "retraction"]
    assert all(graph.owners[node.first] == graph.owners[node.last - 1] == node.capture for node in graph.nodes)


def test_motion_graph_edges_join_similar_windows_of_connected_clips(graph):
    assert graph.connected == {0, 1, 2}
    distances = np.linalg.norm(graph.windows[graph.edges[:, 0]] - graph.windows[graph.edges[:, 1]], axis=1)
    assert 0.0 < distances.max() <= graph.threshold
    assert (graph.owners[graph.edges[:, 0]] != graph.owners[graph.edges[:, 1]]).all()


def test_motion_graph_edges_are_all_local_minima_of_the_window_distance(graph):
    table = np.linalg.norm(graph.windows[:, None] - graph.windows, axis=2)
    owners, edges = graph.owners, {tuple(edge) for edge in graph.edges.tolist()}
    for i, j in product(np.unique(graph.edges), repeat=2):
        if owners[i] == owners[j]:
            continue
        around = [
            table[i + di, j + dj]
            for di, dj in ((1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
            if 0 <= i + di < len(owners) and 0 <= j + dj < len(owners)
            if owners[i + di] == owners[i] and owners[j + dj] == owners[j]
        ]
        margin = min(graph.threshold, *around) - table[i, j]
        assert ((i, j) in edges) == (margin >= 0.0) or abs(margin) < 1e-9


def test_transition_distance_of_two_clips_is_the_distance_of_their_nearest_windows(graph):
    exits = [k for k in range(len(graph.times)) if graph.owners[k] == 0 and 1.4 <= graph.times[k] <= 1.9]
    entries = [k for k in range(len(graph.times)) if graph.owners[k] == 1 and abs(graph.times[k] - 0.4) < 0.01]
    nearest = min(np.linalg.norm(graph.windows[i] - graph.windows[j]) for i in exits for j in entries)
    assert graph.transitions[0, 1] == pytest.approx(nearest, abs=1e-6)
    assert graph.transitions[0, 3] > graph.transitions[0, 1] + 1.0


def requests(*strokes: float, candidates=(0, 1, 2)) -> list[GestureRequest]:
    return [GestureRequest(stroke, tuple(candidates)) for stroke in strokes]


def test_motion_graph_search_uses_no_clip_twice_within_the_repetition_time(graph):
    choices = search_path(graph, requests(1.0, 3.0, 5.0, 7.0))
    assert len({choice.capture for choice in choices if choice}) == 3
    assert choices.count(None) == 1
    later = search_path(graph, requests(1.0, 1.0 + REPETITION_TIME, candidates=(0,)))
    assert [choice.capture for choice in later] == [0, 0]


def total(path) -> float:
    return sum(LEAVE_COST if choice is None else choice.cost for choice in path)


def test_motion_graph_search_finds_a_path_as_cheap_as_the_best_order_of_clips(graph):
    wanted = requests(1.0, 2.2, 3.5, candidates=(0, 1, 3))
    best = search_path(graph, wanted)
    cost = total(best)
    for order in ((0, 1, 3), (0, 3, 1), (1, 0, 3), (1, 3, 0), (3, 0, 1), (3, 1, 0)):
        forced = [replace(request, candidates=(k,)) for request, k in zip(wanted, order, strict=True)]
        other = search_path(graph, forced)
        assert cost <= total(other) + 1e-9


def test_clip_soon_after_another_is_the_nearest_one_and_any_clip_follows_a_long_pause(graph):
    soon = search_path(graph, [GestureRequest(1.0, (0,)), GestureRequest(2.5, (1, 3))])
    assert soon[1].capture == 1
    assert soon[1].distance == pytest.approx(graph.transitions[0, 1])
    late = search_path(graph, [GestureRequest(1.0, (0,)), GestureRequest(9.0, (3,))])
    assert (late[1].capture, late[1].distance) == (3, 0.0)


def test_motion_graph_search_gives_no_clip_to_one_of_two_strokes_0_45_s_apart(graph):
    hurried = search_path(graph, [GestureRequest(1.0, (0,)), GestureRequest(1.45, (1,))])
    assert hurried.count(None) == 1


def test_pace_of_the_style_selects_fast_or_slow_clips():
    quick, slow = capture("quick", 0.0, 0.5), capture("slow", 0.0, 0.1)
    graph = build_graph([quick, slow])
    assert search_path(graph, requests(1.0, candidates=(0, 1)), pace=1.0)[0].capture == 0
    assert search_path(graph, requests(1.0, candidates=(0, 1)), pace=-1.0)[0].capture == 1


def test_gesture_request_without_candidate_clips_gets_no_clip(graph):
    assert search_path(graph, [GestureRequest(1.0, ())]) == [None]
    assert search_path(graph, []) == []


def test_motion_graph_windows_of_a_one_handed_motion_are_finite():
    left = replace(capture("left"), motion=replace(motion(sides="l"), head=sealed(np.zeros((100, 3)))))
    assert np.isfinite(build_graph([left, capture("right")]).windows).all()
