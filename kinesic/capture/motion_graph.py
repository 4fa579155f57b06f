"""Motion graph of captured gestures (thesis chapter 10).

Nodes are the phases of the clips. An edge leads from a window of one clip to a similar window of another: a local
minimum of the distance of positions and velocities, found by a spatial tree. Edges between clips that are not strongly
connected are left out, so that every path can be continued.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.lexicon.captured_gesture import GestureCapture
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion

Indices = NDArray[np.intp]

WINDOW_INTERVAL = 0.1  # [s] interval between the windows of a clip
WINDOW_OFFSETS = (-0.165, 0.0, 0.165)  # [s] times within a window at which motions are compared
VELOCITY_WEIGHT = 0.1  # [s] weight of velocities relative to positions
ELBOW_WEIGHT = 0.15  # [arm lengths/rad] weight of the elbow swivel: half a wrist's weight at its usual radius
HEAD_WEIGHT = 0.3  # [arm lengths/rad] weight of the head's rotation
THRESHOLD_PERCENTILE = 90.0  # percentile of the distance of successive windows that bounds edges between clips
EXIT_TIME = 0.3  # [s] time after `relax` until which a clip may be left
PAIRS_PER_BLOCK = 20_000  # number of pairs of windows whose distances are computed at once, which bounds the memory
TREE_DIMENSIONS = 6  # number of principal components in the spatial tree
HANGING_WRIST = (0.02, 0.40, -0.45)  # [arm lengths] position of a wrist that a motion lacks
CLIP_PHASES = (  # phases of a clip with the markers at their ends
    ("preparation", "start", "strokeStart"),
    ("stroke", "strokeStart", "strokeEnd"),
    ("hold", "strokeEnd", "relax"),
    ("retraction", "relax", "end"),
)


@dataclass(frozen=True, eq=False)
class PhaseNode:
    """Phase of a captured gesture with its windows."""

    capture: int  # index of the gesture
    phase: str  # preparation, stroke, hold or retraction
    first: int  # index of its first window in the graph
    last: int  # index after its last window


@dataclass(frozen=True, eq=False)
class MotionGraph:
    """Phases of captured gestures with transitions between similar windows."""

    captures: tuple[GestureCapture, ...]
    nodes: tuple[PhaseNode, ...]
    windows: Floats  # (w, f) [arm lengths] weighted positions and velocities, comparable by distance
    owners: Indices  # (w,) index of the gesture of each window
    times: Floats  # (w,) [s] times of the windows in their motions
    threshold: float  # [arm lengths] largest distance of an edge's windows
    transitions: Floats  # (n, n) [arm lengths] smallest distance from the end of a stroke to the start of another

    @cached_property
    def edges(self) -> Indices:
        """Transitions (e, 2): window that is left, and window that is entered."""
        return _keep_connected(_find_edges(self.windows, self.owners, self.threshold), self.owners)

    @property
    def connected(self) -> frozenset[int]:
        """Indices of the gestures in the largest strongly connected component."""
        return frozenset(int(owner) for owner in np.unique(self.owners[self.edges]))


def build_graph(captures: Sequence[GestureCapture]) -> MotionGraph:
    """Build the motion graph of captured gestures.

    Args:
        captures: at least one gesture.
    """
    rows = [_window_times(capture) for capture in captures]
    windows = np.concatenate([_describe(capture.motion, times) for capture, times in zip(captures, rows, strict=True)])
    owners = np.repeat(np.arange(len(captures)), [len(times) for times in rows])
    steps = np.linalg.norm(np.diff(windows, axis=0), axis=1)[np.diff(owners) == 0]
    threshold = float(np.percentile(steps, THRESHOLD_PERCENTILE)) if len(steps) else 0.0
    times = np.concatenate(rows)
    return MotionGraph(
        captures=tuple(captures),
        nodes=tuple(_list_nodes(captures, rows)),
        windows=sealed(windows),
        owners=owners,
        times=sealed(times),
        threshold=threshold,
        transitions=_measure_transitions(captures, windows, owners, times),
    )


def _window_times(capture: GestureCapture) -> Floats:
    """Return the window times of a capture [s]."""
    end = float(capture.motion.times[-1])
    return np.arange(0.0, max(end, WINDOW_INTERVAL), WINDOW_INTERVAL)


def _describe(motion: GestureMotion, times: Floats) -> Floats:
    """Return the weighted features (m, f) of windows at given times."""
    positions = np.concatenate(
        [*(_place_arm(motion, side == "l") for side in SIDES), HEAD_WEIGHT * motion.head], axis=1
    )
    velocities = VELOCITY_WEIGHT * np.gradient(positions, motion.times, axis=0)
    features = np.concatenate([positions, velocities], axis=1)
    samples = [
        np.stack([np.interp(times + offset, motion.times, column) for column in features.T], axis=1)
        for offset in WINDOW_OFFSETS
    ]
    windows: Floats = np.concatenate(samples, axis=1) / np.sqrt(len(WINDOW_OFFSETS))
    return windows


def _place_arm(motion: GestureMotion, is_left: bool) -> Floats:
    """Return wrist position and weighted swivel (m, 4) of an arm."""
    hand = motion.hands.get("l" if is_left else "r")
    if hand is None:
        return np.tile([*HANGING_WRIST, 0.0], (len(motion.times), 1))
    return np.column_stack([hand.wrist, ELBOW_WEIGHT * np.unwrap(hand.swivel)])


def _list_nodes(captures: Sequence[GestureCapture], rows: Sequence[Floats]) -> list[PhaseNode]:
    nodes: list[PhaseNode] = []
    first = 0
    for k, (capture, times) in enumerate(zip(captures, rows, strict=True)):
        for phase, start, end in CLIP_PHASES:
            inside = np.searchsorted(times, [capture.markers[start], capture.markers[end]])
            if inside[1] > inside[0]:
                nodes.append(PhaseNode(k, phase, first + int(inside[0]), first + int(inside[1])))
        first += len(times)
    return nodes


def _find_edges(windows: Floats, owners: Indices, threshold: float) -> Indices:
    """Return window pairs (e, 2) of different clips at distance minima.

    A spatial tree limits the search. Its points are the principal components of the windows, whose distance is never
    larger than that of the windows.
    """
    components = np.linalg.svd(windows - windows.mean(axis=0), full_matrices=False)[2][:TREE_DIMENSIONS]
    pairs: Indices = cKDTree(windows @ components.T).query_pairs(threshold, output_type="ndarray")
    pairs = pairs[owners[pairs[:, 0]] != owners[pairs[:, 1]]]
    blocks = np.array_split(pairs, 1 + len(pairs) // PAIRS_PER_BLOCK)
    distances = np.concatenate(
        [np.linalg.norm(windows[block[:, 0]] - windows[block[:, 1]], axis=1) for block in blocks]
    )
    pairs, distances = pairs[distances <= threshold], distances[distances <= threshold]
    keys = pairs[:, 0] * len(windows) + pairs[:, 1]
    order = np.argsort(keys)
    keys, pairs, distances = keys[order], pairs[order], distances[order]
    least = distances.copy()  # smallest distance among a pair and its neighbours; other neighbours are farther apart
    for step in ((1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1)):
        neighbours = pairs + step
        wanted = neighbours[:, 0] * len(windows) + neighbours[:, 1]
        found = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1) if len(keys) else np.zeros(0, dtype=np.intp)
        is_near = (keys[found] == wanted) & (owners[pairs[found]] == owners[pairs]).all(axis=1)
        least = np.where(is_near, np.minimum(least, distances[found]), least)
    kept = pairs[distances <= least]
    edges: Indices = np.concatenate([kept, kept[:, ::-1]]).astype(np.intp)
    return edges


def _keep_connected(edges: Indices, owners: Indices) -> Indices:
    """Keep the edges between windows of the largest strongly connected component.

    Windows of one clip are connected in the direction of time.
    """
    count = len(owners)
    inner = np.flatnonzero(np.diff(owners) == 0)
    starts = np.concatenate([inner, edges[:, 0]])
    ends = np.concatenate([inner + 1, edges[:, 1]])
    links = coo_array((np.ones(len(starts)), (starts, ends)), shape=(count, count))
    labels = connected_components(links.tocsr(), directed=True, connection="strong")[1]
    largest = int(np.bincount(labels).argmax())
    kept: Indices = edges[(labels[edges] == largest).all(axis=1)]
    return kept


def _measure_transitions(captures: Sequence[GestureCapture], windows: Floats, owners: Indices, times: Floats) -> Floats:
    """Return smallest window distances (n, n) from stroke ends to stroke starts."""
    exits, entries = [], []
    for k, capture in enumerate(captures):
        markers = capture.markers
        row = np.flatnonzero(owners == k)
        exits.append(_choose(row, times, markers["strokeEnd"], markers["relax"] + EXIT_TIME))
        entries.append(_choose(row, times, markers["ready"], markers["strokeStart"]))
    entry_rows = np.concatenate(entries)
    bounds = np.concatenate([[0], np.cumsum([len(row) for row in entries])])
    result = np.empty((len(captures), len(captures)))
    for k, row in enumerate(exits):
        squares = (
            np.sum(windows[row] ** 2, axis=1)[:, None]
            + np.sum(windows[entry_rows] ** 2, axis=1)
            - 2.0 * windows[row] @ windows[entry_rows].T
        ).min(axis=0)
        result[k] = [squares[a:b].min() for a, b in pairwise(bounds)]
    return sealed(np.sqrt(np.maximum(result, 0.0)))


def _choose(row: Indices, times: Floats, first: float, last: float) -> Indices:
    """Return the windows within a time span, or nearest its start."""
    inside = row[(times[row] >= first) & (times[row] <= last)]
    chosen: Indices = inside if len(inside) else row[[int(np.argmin(np.abs(times[row] - first)))]]
    return chosen
