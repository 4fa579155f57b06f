"""Plots of moving joints: requested, planned and performed angles."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import PART_CHAINS, Robot
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.syncs import SyncTime
from kinesic.report.plots.axes import FIGURE_WIDTH, Figure, PlotAxes, ThemeColour
from kinesic.report.plots.fitting import fit_text, spaced_indices, thin_line

CHAIN_PAIRS = (("torso", "neck"), ("r_arm", "l_arm"))  # chains drawn side by side
CHAIN_PARTS = {chain: part for part, chain in PART_CHAINS.items()}  # body part in key frames, by kinematic chain
OTHER_TITLE = "other hinges"  # title of the plot of joints outside all chains
CHAIN_NAMES = {"l_arm": "left arm", "r_arm": "right arm"}  # names of chains in plots
MIN_DRAWN_TRAVEL = 0.5  # [deg] joints that move less are not drawn
MIN_PANEL_SPAN = 10.0  # [deg] smallest y range, which keeps noise from looking like motion
LEFT_MARGIN = 0.45  # [in] margin left of the panels
RIGHT_MARGIN = 0.1  # [in] margin right of the panels
COLUMN_GAP = 0.55  # [in] gap between two columns of panels
TOP_MARGIN = 0.46  # [in] margin above the panels
PANEL_HEIGHT = 0.95  # [in] height of a joint's panel with its heading
HEADING_HEIGHT = 0.2  # [in] height of the joint's name above a panel
BOTTOM_MARGIN = 0.3  # [in] margin below the panels
MAX_SYNC_LINES = 100  # largest number of sync points drawn in a panel; if there are more, only strokes are drawn
LABEL_WIDTH = 0.62  # [in] width reserved for the behaviour's name at a stroke


@dataclass(frozen=True, eq=False)
class HingeCurves:
    """Requested, planned and performed angles (m, n) [deg] over time."""

    curves: tuple[Floats, Floats, Floats]
    moving: Flags  # (n,) whether all curves of a hinge together span `MIN_DRAWN_TRAVEL` or more

    @classmethod
    def of(cls, performance: DryRun) -> "HingeCurves":
        """Sample plan and performance once for all plots of a page."""
        plan, measured, desired = performance.plan, performance.measured, performance.plan.desired
        requested = desired.sample(measured.times - plan.trajectory.zero + desired.zero)[0]
        curves = np.degrees(requested), np.degrees(performance.reference.angles), np.degrees(measured.angles)
        return cls(curves, np.asarray(np.ptp(np.concatenate(curves), axis=0) >= MIN_DRAWN_TRAVEL))


def joints(performance: DryRun, seen: HingeCurves) -> Iterator[Markup]:
    """Yield plots of torso and neck, of both arms, of other joints.

    Joints that hardly move are left out, and figures without others, too.
    """
    robot, moving = performance.plan.setup.robot, seen.moving
    columns = {name: robot.joints(name) for pair in CHAIN_PAIRS for name in pair}
    columns[OTHER_TITLE] = tuple(
        sorted(set(range(len(moving))) - {joint for column in columns.values() for joint in column})
    )
    for left, right in (*CHAIN_PAIRS, (OTHER_TITLE, "")):
        rows = zip_longest(columns[left], columns.get(right, ()))
        shown = [row for row in rows if any(joint is not None and moving[joint] for joint in row)]
        if shown:
            yield _figure(performance, (left, right), shown, seen)


def still_hinges(performance: DryRun, seen: HingeCurves) -> list[str]:
    """Return the names of joints that move too little to plot."""
    names = performance.plan.setup.robot.skeleton.names
    return [name for name, moves in zip(names, seen.moving, strict=True) if not moves]


def _figure(
    performance: DryRun,
    names: tuple[str, str],
    rows: list[tuple[int | None, int | None]],
    seen: HingeCurves,
) -> Markup:
    drawn = Figure(TOP_MARGIN + PANEL_HEIGHT * len(rows) + BOTTOM_MARGIN)
    width = (FIGURE_WIDTH - LEFT_MARGIN - RIGHT_MARGIN - COLUMN_GAP) / 2
    left, moving = LEFT_MARGIN, seen.moving
    for column, name in enumerate(names):
        shown = [(row, joint) for row, pair in enumerate(rows) if (joint := pair[column]) is not None and moving[joint]]
        syncs = _syncs(performance, name)
        for row, joint in shown:
            bottom = BOTTOM_MARGIN + PANEL_HEIGHT * (len(rows) - 1 - row)
            axes = drawn.axes(left, bottom, width, PANEL_HEIGHT - HEADING_HEIGHT, timed=True)
            axes.labelled = row == shown[-1][0]
            _panel(axes, performance, joint, seen.curves, syncs)
            if row == shown[0][0]:
                drawn.write(left, bottom + PANEL_HEIGHT + 0.2, CHAIN_NAMES.get(name, name))
                _label(axes, performance, syncs, width)
        left += width + COLUMN_GAP if shown else 0.0
    return drawn.svg()


def _panel(
    axes: PlotAxes,
    performance: DryRun,
    joint: int,
    curves: tuple[Floats, Floats, Floats],
    syncs: list[SyncTime],
) -> None:
    times, robot = performance.measured.times, performance.plan.setup.robot
    axes.limit_x(0.0, performance.duration)
    _mark(axes, performance, syncs)
    styles = ((ThemeColour.ASKED, 2.6, False), (ThemeColour.PLANNED, 1.2, False), (ThemeColour.PERFORMED, 1.0, True))
    for curve, (colour, width, dashed) in zip(curves, styles, strict=True):
        axes.line(*thin_line(times, curve[:, joint]), colour, width=width, dashed=dashed)
    low, high = (
        float(limit) for limit in (min(c[:, joint].min() for c in curves), max(c[:, joint].max() for c in curves))
    )
    room = max(0.12 * (high - low), (MIN_PANEL_SPAN - (high - low)) / 2)
    axes.limit_y(low - room, high + room)
    _shade(axes, robot, joint)
    hinge = robot.skeleton.hinges[joint]
    span = f"range {np.degrees(hinge.lower):.0f}\u2026{np.degrees(hinge.upper):.0f}\u00b0"
    axes.write_heading(hinge.name, span, height=1.06)


def _shade(axes: PlotAxes, robot: Robot, joint: int) -> None:
    """Shade the angles outside a joint's range."""
    low, high = axes.y_limits
    hinge = robot.skeleton.hinges[joint]
    lower, upper = float(np.degrees(hinge.lower)), float(np.degrees(hinge.upper))
    if low < lower:
        axes.band(low, lower, ThemeColour.OUTSIDE)
    if high > upper:
        axes.band(upper, high, ThemeColour.OUTSIDE)


def _syncs(performance: DryRun, chain: str) -> list[SyncTime]:
    """Return the sync points of all behaviours that move a kinematic chain."""
    plan = performance.plan
    part = CHAIN_PARTS.get(chain)
    return [sync for sync in plan.syncs if part in plan.keyframes.uses.get(sync.behaviour, frozenset())]


def _mark(axes: PlotAxes, performance: DryRun, syncs: list[SyncTime]) -> None:
    """Mark sync points by vertical lines, only strokes if there are many."""
    zero = performance.plan.trajectory.zero
    for strong in (False, True) if len(syncs) <= MAX_SYNC_LINES else (True,):
        times = [zero + sync.planned for sync in syncs if sync.is_stroke == strong]
        colour, width = (ThemeColour.FAINT, 0.9) if strong else (ThemeColour.GRID, 0.7)
        axes.verticals(times, colour, width=width)


def _label(axes: PlotAxes, performance: DryRun, syncs: list[SyncTime], width: float) -> None:
    """Label strokes with behaviour names, without overlaps."""
    zero = performance.plan.trajectory.zero
    strokes = [sync for sync in syncs if sync.is_stroke]
    per_second = width / performance.duration
    for k in spaced_indices([sync.planned for sync in strokes], LABEL_WIDTH / per_second):
        label = fit_text(strokes[k].behaviour, LABEL_WIDTH)
        axes.write((zero + strokes[k].planned, 1.3), label, colour=ThemeColour.FAINT, place="time", align="center")
