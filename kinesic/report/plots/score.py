"""The block as a score: one row per behaviour over performance time, with its strokes and its words."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from markupsafe import Markup

from kinesic.bml.block import Speech
from kinesic.controller.performance import Performance
from kinesic.planning.plan import Plan
from kinesic.report.plots.svg import (
    WIDTH,
    Colour,
    empty_figure,
    fit_text,
    svg,
    time_axes,
    write_text,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROW, TOP, BOTTOM = 0.21, 0.06, 0.3  # [in]
LEFT, RIGHT = 1.6, 0.1  # [in]
CORES = (("strokeStart", "strokeEnd"), ("ready", "relax"), ("attackPeak", "relax"))  # of gestures, gaze, faces
ROWS = 50  # a longer score is cut, and says so


@dataclass(frozen=True)
class Caption:
    """A piece of speech between two marks."""

    behaviour: str
    begin: float  # [s] performance time
    end: float  # [s] performance time
    text: str


def captions(plan: Plan) -> Iterator[Caption]:
    """Cuts every text at its marks, and says when each piece is heard."""
    for timed in plan.timeline.timed:
        name, action = timed.behaviour.id, timed.behaviour.action
        if not isinstance(action, Speech) or name not in plan.utterances:
            continue
        script, utterance = action.script, plan.utterances[name]
        begin = plan.trajectory.zero + timed.times["start"]
        marks = sorted((m.position, utterance.marks[m.name]) for m in script.marks if m.name in utterance.marks)
        cuts = [(0, 0.0), *marks, (len(script.text), utterance.duration)]
        for (first, start), (last, stop) in pairwise(cuts):
            yield Caption(name, begin + start, begin + stop, " ".join(script.text[first:last].split()))


def score(performance: Performance) -> Markup | None:
    """Draws who does what when; None when nothing is performed."""
    scheduled = {entry.behaviour.id for entry in performance.plan.timeline.timed}
    outcomes = performance.plan.keyframes.outcomes
    behaviours = [b for b in performance.plan.timeline.block.behaviours if b.id in scheduled]
    behaviours = [b for b in behaviours if outcomes[b.id].kind != "dropped"]
    if not behaviours:
        return None
    rows = behaviours[:ROWS]
    height = TOP + ROW * (len(rows) + (len(behaviours) > ROWS)) + BOTTOM
    drawn = empty_figure(height)
    width = WIDTH - LEFT - RIGHT
    axes = drawn.add_axes((LEFT / WIDTH, BOTTOM / height, width / WIDTH, 1 - (TOP + BOTTOM) / height))
    end = float(performance.measured.times[-1])
    time_axes(axes, end=end)
    axes.set_ylim((height - TOP - BOTTOM) / ROW, 0)
    axes.set_yticks([])
    pieces = tuple(captions(performance.plan))
    for row, behaviour in enumerate(rows):
        write_text(axes, (-0.008 * end, row + 0.7), fit_text(behaviour.id, LEFT), place="data", align="right")
        if isinstance(behaviour.action, Speech):
            _words(axes, row, (said for said in pieces if said.behaviour == behaviour.id), width / end)
        else:
            _phases(axes, row, behaviour.id, performance)
    if len(behaviours) > ROWS:
        write_text(
            axes, (0.0, ROWS + 0.7), f"and {len(behaviours) - ROWS} more behaviours", colour=Colour.FAINT, place="data"
        )
    return svg(drawn)


def _phases(axes: "Axes", row: int, name: str, performance: Performance) -> None:
    """From start to end, the stroke or hold in full colour; below it what was asked."""
    zero = performance.plan.trajectory.zero
    syncs = [sync for sync in performance.plan.syncs if sync.behaviour == name]
    if not syncs:
        return
    at = {sync.sync: zero + sync.planned for sync in syncs}
    begin, end = min(at.values()), max(at.values())
    axes.broken_barh([(begin, end - begin)], (row + 0.2, 0.5), color=Colour.PLANNED, alpha=0.3, linewidth=0)
    for first, last in CORES:
        if first in at and last in at:
            axes.broken_barh([(at[first], at[last] - at[first])], (row + 0.2, 0.5), color=Colour.PLANNED, linewidth=0)
            break
    strokes = [sync for sync in syncs if sync.is_stroke]
    axes.vlines([zero + sync.planned for sync in strokes], row + 0.08, row + 0.82, colors=Colour.INK, linewidth=1.2)
    asked = [zero + sync.asked for sync in syncs]
    axes.hlines(row + 0.86, min(asked), max(asked), colors=Colour.ASKED, linewidth=1.8)
    axes.vlines([zero + sync.asked for sync in strokes], row + 0.74, row + 0.98, colors=Colour.ASKED, linewidth=1.8)


def _words(axes: "Axes", row: int, pieces: Iterable[Caption], per_second: float) -> None:
    """The text between its marks, each piece where it is said."""
    for said in pieces:
        axes.broken_barh(
            [(said.begin, said.end - said.begin)], (row + 0.1, 0.8), facecolor=Colour.SPEECH, alpha=0.25, linewidth=0
        )
        axes.vlines(said.begin, row + 0.1, row + 0.9, colors=Colour.SPEECH, linewidth=1.0)
        words = fit_text(said.text, (said.end - said.begin) * per_second - 0.06)
        write_text(axes, (said.begin + 0.03 / per_second, row + 0.7), words, place="data")
