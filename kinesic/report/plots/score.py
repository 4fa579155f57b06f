"""Timeline plot of a block, with one row per behaviour."""

from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from kinesic.bml.block import Speech
from kinesic.planning.captions import Caption, make_captions
from kinesic.planning.plan import Plan
from kinesic.report.labels import label
from kinesic.report.plots.axes import FIGURE_WIDTH, Figure, PlotAxes, ThemeColour
from kinesic.report.plots.fitting import fit_text

TOP_MARGIN = 0.06  # [in] margin above the timeline
BOTTOM_MARGIN = 0.3  # [in] margin below the timeline
CORE_SYNCS = (
    ("strokeStart", "strokeEnd"),
    ("ready", "relax"),
    ("attackPeak", "relax"),
)  # first and last sync point of the main phase of gestures, gaze and faces
MAX_ROWS = 50  # largest number of behaviours in a timeline plot


@dataclass(frozen=True)
class Layout:
    """Dimensions of a timeline plot."""

    style: str  # its classes in the style sheet of the page
    width: float  # [in] of the figure
    left: float  # [in] margin left of the axes, over which the page draws its slider
    right: float  # [in] margin right of the axes
    row: float  # [in] height of a row
    above: float  # fraction of a row's height for its label; 0: the label is left of the axes

    def down(self, row: int, fraction: float) -> float:
        """Return the y coordinate at a fraction of a timeline row's height."""
        return row + self.above + (1.0 - self.above) * fraction


BROAD_LAYOUT = Layout("plot broad", FIGURE_WIDTH, 1.6, 0.1, 0.21, 0.0)  # timeline layout for wide screens
NARROW_LAYOUT = Layout("plot narrow", 3.6, 0.16, 0.16, 0.34, 0.42)  # timeline layout for telephones


def scores(plan: Plan, end: float) -> list[Markup]:
    """Draw the behaviour timeline for wide and narrow screens."""
    return [drawn for layout in (BROAD_LAYOUT, NARROW_LAYOUT) if (drawn := draw_timeline(plan, end, layout))]


def draw_timeline(plan: Plan, end: float, layout: Layout = BROAD_LAYOUT) -> Markup | None:
    """Draw the timeline of performed behaviours, or return None without behaviours.

    Args:
        plan: plan of the behaviours.
        end: performance time at which the timeline ends [s].
        layout: dimensions of the drawing.
    """
    scheduled = {entry.behaviour.id for entry in plan.timeline.timed}
    outcomes = plan.keyframes.outcomes
    behaviours = [b for b in plan.timeline.block.behaviours if b.id in scheduled]
    behaviours = [b for b in behaviours if outcomes[b.id].kind != "dropped"]
    if not behaviours:
        return None
    rows = behaviours[:MAX_ROWS]
    count, width = len(rows) + (len(behaviours) > MAX_ROWS), layout.width - layout.left - layout.right
    drawn = Figure(TOP_MARGIN + layout.row * count + BOTTOM_MARGIN, width=layout.width, style=layout.style)
    axes = drawn.axes(layout.left, BOTTOM_MARGIN, width, layout.row * count, timed=True)
    axes.limit_x(0.0, end)
    axes.limit_y(count, 0.0)
    axes.ticks = 0
    pieces = tuple(make_captions(plan))
    for row, behaviour in enumerate(rows):
        _label(axes, row, label(behaviour), _span(behaviour.id, plan), end, layout)
        if isinstance(behaviour.action, Speech):
            spoken = (piece for piece in pieces if piece.behaviour == behaviour.id)
            _words(axes, row, spoken, width / end, layout)
        else:
            _phases(axes, row, behaviour.id, plan, layout)
    if len(behaviours) > MAX_ROWS:
        more = f"and {len(behaviours) - MAX_ROWS} more behaviours"
        axes.write((0.0, MAX_ROWS + 0.7), more, colour=ThemeColour.FAINT, place="data")
    return drawn.svg()


def _span(name: str, plan: Plan) -> tuple[float, float]:
    """Return start and end [s] of a behaviour."""
    times = [sync.planned for sync in plan.syncs if sync.behaviour == name] or [0.0]
    zero = plan.trajectory.zero
    return zero + min(times), zero + max(times)


def _label(axes: PlotAxes, row: int, words: str, span: tuple[float, float], end: float, layout: Layout) -> None:
    """Write a behaviour's name left of the axes or above its bar.

    Above the bar it begins at the start, or ends at the end if there is no space otherwise.
    """
    if not layout.above:
        axes.write((-0.008 * end, row + 0.7), fit_text(words, layout.left), place="data", align="right")
        return
    begin, last = max(span[0], 0.0), min(span[1], end)
    inches = (layout.width - layout.left - layout.right) / end
    behind, before = fit_text(words, (end - begin) * inches), fit_text(words, last * inches)
    is_left = behind == words or len(behind) >= len(before)
    place, shown = (begin, behind) if is_left else (last, before)
    axes.write((place, row + 0.9 * layout.above), shown, place="data", align="left" if is_left else "right")


def _phases(axes: PlotAxes, row: int, name: str, plan: Plan, layout: Layout) -> None:
    """Draw a behaviour's duration, stroke and requested times."""
    zero = plan.trajectory.zero
    syncs = [sync for sync in plan.syncs if sync.behaviour == name]
    if not syncs:
        return
    at = {sync.sync: zero + sync.planned for sync in syncs}
    top, foot = layout.down(row, 0.2), layout.down(row, 0.7)
    axes.bars([(min(at.values()), max(at.values()))], top, foot, ThemeColour.PLANNED, 0.3)
    for first, last in CORE_SYNCS:
        if first in at and last in at:
            axes.bars([(at[first], at[last])], top, foot, ThemeColour.PLANNED)
            break
    strokes, high = [sync for sync in syncs if sync.is_stroke], layout.down(row, 0.08)
    axes.verticals(
        [zero + sync.planned for sync in strokes], ThemeColour.INK, width=1.2, span=(high, layout.down(row, 0.82))
    )
    requested_times = [zero + sync.requested for sync in syncs]
    axes.level(layout.down(row, 0.86), ThemeColour.ASKED, width=1.8, span=(min(requested_times), max(requested_times)))
    below = (layout.down(row, 0.74), layout.down(row, 0.98))
    axes.verticals([zero + sync.requested for sync in strokes], ThemeColour.ASKED, width=1.8, span=below)


def _words(axes: PlotAxes, row: int, pieces: Iterable[Caption], per_second: float, layout: Layout) -> None:
    """Draw the spoken text pieces over time."""
    top, foot = layout.down(row, 0.1), layout.down(row, 0.9)
    for caption in pieces:
        axes.bars([(caption.begin, caption.end)], top, foot, ThemeColour.SPEECH, 0.25)
        axes.verticals([caption.begin], ThemeColour.SPEECH, span=(top, foot))
        words = fit_text(caption.text, (caption.end - caption.begin) * per_second - 0.06)
        axes.write((caption.begin + 0.03 / per_second, layout.down(row, 0.7)), words, place="data")
