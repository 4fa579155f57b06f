"""Search for a sentence's best captured gestures in a motion graph."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.capture.motion_graph import Indices, MotionGraph

REPETITION_TIME = 20.0  # [s] time within which no clip is performed twice
REST_GAP = 1.5  # [s] pause between two gestures from which the hands return to rest, so that any clip may follow
BEAM_WIDTH = 48  # number of partial paths that are kept
MISMATCH_WEIGHT = 1.0  # cost per arm length by which a transition exceeds the distance threshold of the graph
STRETCH_WEIGHT = 2.0  # cost per unit of log time ratio, where a clip has less time than in the capture
STYLE_WEIGHT = 0.3  # cost per unit of difference between the clip's relative velocity and the style's
MIN_LEAD = 0.02  # [s] shortest assumed time from strokeStart to stroke
MIN_TIME_RATIO = 0.05  # smallest ratio of available to captured time, below which the cost no longer grows
NO_CLIP = -1  # index that stands for a gesture without a clip
LEAVE_COST = 1.2  # cost of a gesture without a clip, which the lexicon then performs


@dataclass(frozen=True)
class GestureRequest:
    """Gesture of a sentence for which clips are compared."""

    stroke: float  # [s] estimated time of the gesture's stroke
    candidates: tuple[int, ...]  # indices of the clips that have the gesture's meaning


@dataclass(frozen=True)
class ClipChoice:
    """Clip chosen for a gesture, with the costs that decided."""

    capture: int  # index of the clip
    distance: float  # [arm lengths] difference of the previous gesture's last pose and the clip's first; 0 after a rest
    stretch: float  # available time / captured time, at most 1
    cost: float  # total cost of the choice


def search_path(
    graph: MotionGraph,
    requests: Sequence[GestureRequest],
    *,
    pace: float = 0.0,
    earlier: Sequence[GestureRequest] = (),
) -> list[ClipChoice | None]:
    """Return the clips of a sentence's gestures with the least total cost.

    Costs are the distances of transitions, missing time, and the difference from the style. No clip occurs twice within
    `REPETITION_TIME`. A gesture without a suitable clip gets None.

    Args:
        graph: of the clips.
        requests: in the order of their strokes.
        pace: of the style: -1 slow and weak, 0 neutral, 1 fast and forceful.
        earlier: gestures before the sentence, each with its clip as the only candidate.
    """
    times = np.array([request.stroke for request in (*earlier, *requests)])
    features = _StrokeFeatures.of(graph)
    past = [request.candidates[0] for request in earlier]
    costs, history = np.zeros(1), np.array([past], dtype=np.intp)  # total cost and clips of each kept path
    for number, request in enumerate(requests, len(past)):
        options = np.array([*request.candidates, NO_CLIP], dtype=np.intp)
        recent = history[:, times[number] - times[:number] < REPETITION_TIME]
        step = features.cost(history, options, np.diff(times[number - 1 : number + 1]), pace)
        step[(recent[:, :, None] == options).any(axis=1) & (options != NO_CLIP)] = np.inf
        totals = (costs[:, None] + step).ravel()
        best = np.argsort(totals, kind="stable")[:BEAM_WIDTH]
        best = best[np.isfinite(totals[best])]
        paths, chosen = np.divmod(best, len(options))
        costs, history = totals[best], np.column_stack([history[paths], options[chosen]])
    return _describe_path(history[0], times, features, pace)[len(past) :]


@dataclass(frozen=True, eq=False)
class _StrokeFeatures:
    """Times, velocities and transitions of the strokes of all clips.

    The last row and column stand for a gesture without a clip.
    """

    transitions: Floats  # (n + 1, n + 1) [arm lengths] distances from the end of a stroke to the start of another
    threshold: float  # [arm lengths] distance up to which motions match
    leads: Floats  # (n + 1,) [s] time from strokeStart to stroke
    tails: Floats  # (n + 1,) [s] time from stroke to strokeEnd
    paces: Floats  # (n + 1,) rank of the mean wrist velocity among all clips, -1..1

    @classmethod
    def of(cls, graph: MotionGraph) -> "_StrokeFeatures":
        """Collect the features of a graph's clips."""
        markers = [capture.markers for capture in graph.captures]
        leads = [times["stroke"] - times["strokeStart"] for times in markers]
        tails = [times["strokeEnd"] - times["stroke"] for times in markers]
        speeds = np.array([_mean_velocity(graph, k) for k in range(len(markers))])
        ranks = np.argsort(np.argsort(speeds, kind="stable"), kind="stable")
        paces = 2.0 * ranks / max(len(speeds) - 1, 1) - 1.0
        return cls(
            np.pad(graph.transitions, (0, 1)),
            graph.threshold,
            np.array([*leads, 0.0]),
            np.array([*tails, 0.0]),
            np.array([*paces, 0.0]),
        )

    def join(self, last: Indices, options: Indices, gap: Floats) -> tuple[Floats, Floats]:
        """Return distances and time ratios (p, c) of transitions between clips.

        Args:
            last: (p,) clips before.
            options: (c,) clips after.
            gap: (1,) [s] between the strokes; empty before the first stroke.
        """
        shape = len(last), len(options)
        if not len(gap):
            return np.zeros(shape), np.ones(shape)
        available = gap - self.tails[last][:, None] - np.zeros(len(options))
        leads = self.leads[options]
        rests = (available - leads >= REST_GAP) | (last == NO_CLIP)[:, None] | (options == NO_CLIP)
        distances = np.where(rests, 0.0, self.transitions[np.ix_(last, options)])
        ratios = np.where(rests, 1.0, np.clip(available / np.maximum(leads, MIN_LEAD), MIN_TIME_RATIO, 1.0))
        return distances, ratios

    def cost(self, history: Indices, options: Indices, gap: Floats, pace: float) -> Floats:
        """Return the costs (p, c) of clips after each kept path."""
        last = history[:, -1] if history.shape[1] else np.full(len(history), NO_CLIP)
        distances, ratios = self.join(last, options, gap)
        beyond = np.maximum(distances - self.threshold, 0.0)
        costs = distances + MISMATCH_WEIGHT * beyond - STRETCH_WEIGHT * np.log(ratios)
        style = STYLE_WEIGHT * np.abs(self.paces[options] - pace)
        total: Floats = np.where(options == NO_CLIP, LEAVE_COST, costs + style)
        return total


def _describe_path(path: Indices, times: Floats, features: _StrokeFeatures, pace: float) -> list[ClipChoice | None]:
    """Return the choices along a path, with their transitions and costs."""
    choices: list[ClipChoice | None] = []
    for number, k in enumerate(path):
        if k == NO_CLIP:
            choices.append(None)
            continue
        before, option = path[None, :number], path[number : number + 1]
        gap = np.diff(times[number - 1 : number + 1])
        last = before[:, -1] if number else np.full(1, NO_CLIP)
        distances, ratios = features.join(last, option, gap)
        cost = float(features.cost(before, option, gap, pace)[0, 0])
        choices.append(ClipChoice(int(k), float(distances[0, 0]), float(ratios[0, 0]), cost))
    return choices


def _mean_velocity(graph: MotionGraph, k: int) -> float:
    """Return the mean wrist velocity of a clip's stroke [arm lengths/s]."""
    capture = graph.captures[k]
    motion = capture.motion
    inside = (motion.times >= capture.markers["strokeStart"]) & (motion.times <= capture.markers["strokeEnd"])
    duration = max(float(np.ptp(motion.times[inside])), 0.1) if inside.any() else 0.1
    lengths = [
        float(np.linalg.norm(np.diff(motion.hands[side].wrist[inside], axis=0), axis=1).sum()) for side in capture.sides
    ]
    return max(lengths) / duration
