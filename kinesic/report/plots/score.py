"""The block as a score: one row per behaviour over performance time, with its strokes and its words."""

from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from kinesic.bml.block import Speech
from kinesic.controller.performance import Performance
from kinesic.planning.captions import Caption, captions
from kinesic.report.labels import label
from kinesic.report.plots.axes import WIDTH, Axes, Figure, ThemeColour
from kinesic.report.plots.fitting import fit_text

TOP, BOTTOM = 0.06, 0.3  # [in]
CORES = (("strokeStart", "strokeEnd"), ("ready", "relax"), ("attackPeak", "relax"))  # of gestures, gaze, faces
ROWS = 50  # a longer score is cut, and says so


@dataclass(frozen=True)
class Layout:
    """How a score is laid out."""

    style: str  # its classes in the style sheet of the page
    width: float  # [in]
    left: float  # [in] from there the axes; the slider of the page stands over them
    right: float  # [in]
    row: float  # [in] height
    above: float  # share of a row that its label takes; 0: it stands left of the axes

    def down(self, row: int, share: float) -> float:
        """Finds the ordinate of a share of what a row shows."""
        return row + self.above + (1.0 - self.above) * share


BROAD = Layout("plot broad", WIDTH, 1.6, 0.1, 0.21, 0.0)
NARROW = Layout("plot narrow", 3.6, 0.16, 0.16, 0.34, 0.42)  # of a telephone


def score(performance: Performance, layout: Layout = BROAD) -> Markup | None:
    """Draws who does what when; None when nothing is performed."""
    scheduled = {entry.behaviour.id for entry in performance.plan.timeline.timed}
    outcomes = performance.plan.keyframes.outcomes
    behaviours = [b for b in performance.plan.timeline.block.behaviours if b.id in scheduled]
    behaviours = [b for b in behaviours if outcomes[b.id].kind != "dropped"]
    if not behaviours:
        return None
    rows = behaviours[:ROWS]
    count, width = len(rows) + (len(behaviours) > ROWS), layout.width - layout.left - layout.right
    drawn = Figure(TOP + layout.row * count + BOTTOM, width=layout.width, style=layout.style)
    axes = drawn.axes(layout.left, BOTTOM, width, layout.row * count, timed=True)
    end = float(performance.measured.times[-1])
    axes.limit_x(0.0, end)
    axes.limit_y(count, 0.0)
    axes.ticks = 0
    pieces = tuple(captions(performance.plan))
    for row, behaviour in enumerate(rows):
        _label(axes, row, label(behaviour), _span(behaviour.id, performance), end, layout)
        if isinstance(behaviour.action, Speech):
            said = (piece for piece in pieces if piece.behaviour == behaviour.id)
            _words(axes, row, said, width / end, layout)
        else:
            _phases(axes, row, behaviour.id, performance, layout)
    if len(behaviours) > ROWS:
        more = f"and {len(behaviours) - ROWS} more behaviours"
        axes.write((0.0, ROWS + 0.7), more, colour=ThemeColour.FAINT, place="data")
    return drawn.svg()


def _span(name: str, performance: Performance) -> tuple[float, float]:
    """When a behaviour begins and ends [s]."""
    times = [sync.planned for sync in performance.plan.syncs if sync.behaviour == name] or [0.0]
    zero = performance.plan.trajectory.zero
    return zero + min(times), zero + max(times)


def _label(axes: Axes, row: int, words: str, span: tuple[float, float], end: float, layout: Layout) -> None:
    """Left of the axes, or over the bar: from its beginning on, or up to its end where only that leaves room."""
    if not layout.above:
        axes.write((-0.008 * end, row + 0.7), fit_text(words, layout.left), place="data", align="right")
        return
    begin, last = max(span[0], 0.0), min(span[1], end)
    inches = (layout.width - layout.left - layout.right) / end
    behind, before = fit_text(words, (end - begin) * inches), fit_text(words, last * inches)
    is_left = behind == words or len(behind) >= len(before)
    place, shown = (begin, behind) if is_left else (last, before)
    axes.write((place, row + 0.9 * layout.above), shown, place="data", align="left" if is_left else "right")


def _phases(axes: Axes, row: int, name: str, performance: Performance, layout: Layout) -> None:
    """From start to end, the stroke or hold in full colour; below it what was asked."""
    zero = performance.plan.trajectory.zero
    syncs = [sync for sync in performance.plan.syncs if sync.behaviour == name]
    if not syncs:
        return
    at = {sync.sync: zero + sync.planned for sync in syncs}
    top, foot = layout.down(row, 0.2), layout.down(row, 0.7)
    axes.bars([(min(at.values()), max(at.values()))], top, foot, ThemeColour.PLANNED, 0.3)
    for first, last in CORES:
        if first in at and last in at:
            axes.bars([(at[first], at[last])], top, foot, ThemeColour.PLANNED)
            break
    strokes, high = [sync for sync in syncs if sync.is_stroke], layout.down(row, 0.08)
    axes.verticals(
        [zero + sync.planned for sync in strokes], ThemeColour.INK, width=1.2, span=(high, layout.down(row, 0.82))
    )
    asked = [zero + sync.asked for sync in syncs]
    axes.level(layout.down(row, 0.86), ThemeColour.ASKED, width=1.8, span=(min(asked), max(asked)))
    below = (layout.down(row, 0.74), layout.down(row, 0.98))
    axes.verticals([zero + sync.asked for sync in strokes], ThemeColour.ASKED, width=1.8, span=below)


def _words(axes: Axes, row: int, pieces: Iterable[Caption], per_second: float, layout: Layout) -> None:
    """The text between its marks, each piece where it is said."""
    top, foot = layout.down(row, 0.1), layout.down(row, 0.9)
    for said in pieces:
        axes.bars([(said.begin, said.end)], top, foot, ThemeColour.SPEECH, 0.25)
        axes.verticals([said.begin], ThemeColour.SPEECH, span=(top, foot))
        words = fit_text(said.text, (said.end - said.begin) * per_second - 0.06)
        axes.write((said.begin + 0.03 / per_second, layout.down(row, 0.7)), words, place="data")
