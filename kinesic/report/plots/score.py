"""The block as a score: one row per behaviour over performance time, with its strokes and its words."""

from collections.abc import Iterable

from markupsafe import Markup

from kinesic.bml.block import Speech
from kinesic.controller.performance import Performance
from kinesic.planning.captions import Caption, captions
from kinesic.report.labels import label
from kinesic.report.plots.axes import WIDTH, Axes, Colour, Figure
from kinesic.report.plots.fitting import fit_text

ROW, TOP, BOTTOM = 0.21, 0.06, 0.3  # [in]
LEFT, RIGHT = 1.6, 0.1  # [in]
CORES = (("strokeStart", "strokeEnd"), ("ready", "relax"), ("attackPeak", "relax"))  # of gestures, gaze, faces
ROWS = 50  # a longer score is cut, and says so


def score(performance: Performance) -> Markup | None:
    """Draws who does what when; None when nothing is performed."""
    scheduled = {entry.behaviour.id for entry in performance.plan.timeline.timed}
    outcomes = performance.plan.keyframes.outcomes
    behaviours = [b for b in performance.plan.timeline.block.behaviours if b.id in scheduled]
    behaviours = [b for b in behaviours if outcomes[b.id].kind != "dropped"]
    if not behaviours:
        return None
    rows = behaviours[:ROWS]
    count, width = len(rows) + (len(behaviours) > ROWS), WIDTH - LEFT - RIGHT
    drawn = Figure(TOP + ROW * count + BOTTOM)
    axes = drawn.axes(LEFT, BOTTOM, width, ROW * count, timed=True)
    end = float(performance.measured.times[-1])
    axes.limit_x(0.0, end)
    axes.limit_y(count, 0.0)
    axes.ticks = 0
    pieces = tuple(captions(performance.plan))
    for row, behaviour in enumerate(rows):
        axes.write((-0.008 * end, row + 0.7), fit_text(label(behaviour), LEFT), place="data", align="right")
        if isinstance(behaviour.action, Speech):
            _words(axes, row, (said for said in pieces if said.behaviour == behaviour.id), width / end)
        else:
            _phases(axes, row, behaviour.id, performance)
    if len(behaviours) > ROWS:
        more = f"and {len(behaviours) - ROWS} more behaviours"
        axes.write((0.0, ROWS + 0.7), more, colour=Colour.FAINT, place="data")
    return drawn.svg()


def _phases(axes: Axes, row: int, name: str, performance: Performance) -> None:
    """From start to end, the stroke or hold in full colour; below it what was asked."""
    zero = performance.plan.trajectory.zero
    syncs = [sync for sync in performance.plan.syncs if sync.behaviour == name]
    if not syncs:
        return
    at = {sync.sync: zero + sync.planned for sync in syncs}
    begin, end = min(at.values()), max(at.values())
    axes.bars([(begin, end)], row + 0.2, row + 0.7, Colour.PLANNED, 0.3)
    for first, last in CORES:
        if first in at and last in at:
            axes.bars([(at[first], at[last])], row + 0.2, row + 0.7, Colour.PLANNED)
            break
    strokes = [sync for sync in syncs if sync.is_stroke]
    axes.verticals([zero + sync.planned for sync in strokes], Colour.INK, width=1.2, span=(row + 0.08, row + 0.82))
    asked = [zero + sync.asked for sync in syncs]
    axes.level(row + 0.86, Colour.ASKED, width=1.8, span=(min(asked), max(asked)))
    axes.verticals([zero + sync.asked for sync in strokes], Colour.ASKED, width=1.8, span=(row + 0.74, row + 0.98))


def _words(axes: Axes, row: int, pieces: Iterable[Caption], per_second: float) -> None:
    """The text between its marks, each piece where it is said."""
    for said in pieces:
        axes.bars([(said.begin, said.end)], row + 0.1, row + 0.9, Colour.SPEECH, 0.25)
        axes.verticals([said.begin], Colour.SPEECH, span=(row + 0.1, row + 0.9))
        words = fit_text(said.text, (said.end - said.begin) * per_second - 0.06)
        axes.write((said.begin + 0.03 / per_second, row + 0.7), words, place="data")
