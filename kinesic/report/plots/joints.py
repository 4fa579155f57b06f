"""Every hinge that moves: asked against planned against performed, with its range and the sync points."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import CHAINS, Robot
from kinesic.controller.performance import Performance
from kinesic.planning.syncs import SyncTime
from kinesic.report.plots.axes import WIDTH, Axes, Figure, ThemeColour
from kinesic.report.plots.fitting import fit_text, spaced_indices, thin_line

PAIRS = (("torso", "neck"), ("r_arm", "l_arm"))  # side by side
PARTS = {chain: part for part, chain in CHAINS.items()}  # of key frames
OTHERS = "other hinges"  # outside any chain
NAMES = {"l_arm": "left arm", "r_arm": "right arm"}
STILL_HINGE = 0.5  # [deg] a hinge that moves less is not drawn
LEAST_SPAN = 10.0  # [deg] of a panel, so that noise does not look like motion
LEFT, RIGHT, GAP = 0.45, 0.1, 0.55  # [in]
TOP, PANEL, HEAD, BOTTOM = 0.46, 0.95, 0.2, 0.3  # [in]; the head of a panel holds its name
MOST_LINES = 100  # for sync points of a panel
LABEL = 0.62  # [in] of a sync point


@dataclass(frozen=True, eq=False)
class HingeCurves:
    """Angles [deg] of all hinges at the measured times, each (m, n): asked, planned and performed."""

    curves: tuple[Floats, Floats, Floats]
    moving: Flags  # (n,) whether the curves of a hinge leave one place, or one another

    @classmethod
    def of(cls, performance: Performance) -> "HingeCurves":
        """Samples plan and performance, for all figures of a page: what was asked is drawn anew each time."""
        plan, measured, desired = performance.plan, performance.measured, performance.plan.desired
        asked = desired.sample(measured.times - plan.trajectory.zero + desired.zero)[0]
        curves = np.degrees(asked), np.degrees(performance.reference.angles), np.degrees(measured.angles)
        return cls(curves, np.asarray(np.ptp(np.concatenate(curves), axis=0) >= STILL_HINGE))


def joints(performance: Performance, seen: HingeCurves) -> Iterator[Markup]:
    """Draws a figure for torso and neck, one for the arms, one for hinges outside any chain, if they move."""
    robot, moving = performance.plan.setup.robot, seen.moving
    columns = {name: robot.joints(name) for pair in PAIRS for name in pair}
    columns[OTHERS] = tuple(
        sorted(set(range(len(moving))) - {joint for column in columns.values() for joint in column})
    )
    for left, right in (*PAIRS, (OTHERS, "")):
        rows = zip_longest(columns[left], columns.get(right, ()))
        shown = [row for row in rows if any(joint is not None and moving[joint] for joint in row)]
        if shown:
            yield _figure(performance, (left, right), shown, seen)


def still_hinges(performance: Performance, seen: HingeCurves) -> list[str]:
    """Names the hinges that are not drawn."""
    names = performance.plan.setup.robot.skeleton.names
    return [name for name, moves in zip(names, seen.moving, strict=True) if not moves]


def _figure(
    performance: Performance,
    names: tuple[str, str],
    rows: list[tuple[int | None, int | None]],
    seen: HingeCurves,
) -> Markup:
    drawn = Figure(TOP + PANEL * len(rows) + BOTTOM)
    width = (WIDTH - LEFT - RIGHT - GAP) / 2
    left, moving = LEFT, seen.moving
    for column, name in enumerate(names):
        shown = [(row, joint) for row, pair in enumerate(rows) if (joint := pair[column]) is not None and moving[joint]]
        syncs = _syncs(performance, name)
        for row, joint in shown:
            bottom = BOTTOM + PANEL * (len(rows) - 1 - row)
            axes = drawn.axes(left, bottom, width, PANEL - HEAD, timed=True)
            axes.labelled = row == shown[-1][0]
            _panel(axes, performance, joint, seen.curves, syncs)
            if row == shown[0][0]:
                drawn.write(left, bottom + PANEL + 0.2, NAMES.get(name, name))
                _label(axes, performance, syncs, width)
        left += width + GAP if shown else 0.0
    return drawn.svg()


def _panel(
    axes: Axes,
    performance: Performance,
    joint: int,
    curves: tuple[Floats, Floats, Floats],
    syncs: list[SyncTime],
) -> None:
    times, robot = performance.measured.times, performance.plan.setup.robot
    axes.limit_x(0.0, float(times[-1]))
    _mark(axes, performance, syncs)
    styles = ((ThemeColour.ASKED, 2.6, False), (ThemeColour.PLANNED, 1.2, False), (ThemeColour.PERFORMED, 1.0, True))
    for curve, (colour, width, dashed) in zip(curves, styles, strict=True):
        axes.line(*thin_line(times, curve[:, joint]), colour, width=width, dashed=dashed)
    low, high = (
        float(limit) for limit in (min(c[:, joint].min() for c in curves), max(c[:, joint].max() for c in curves))
    )
    room = max(0.12 * (high - low), (LEAST_SPAN - (high - low)) / 2)
    axes.limit_y(low - room, high + room)
    _shade(axes, robot, joint)
    hinge = robot.skeleton.hinges[joint]
    span = f"range {np.degrees(hinge.lower):.0f}\u2026{np.degrees(hinge.upper):.0f}\u00b0"
    axes.head(hinge.name, span, height=1.06)


def _shade(axes: Axes, robot: Robot, joint: int) -> None:
    """Angles outside the range of a hinge, where the panel shows some."""
    low, high = axes.y_limits
    hinge = robot.skeleton.hinges[joint]
    lower, upper = float(np.degrees(hinge.lower)), float(np.degrees(hinge.upper))
    if low < lower:
        axes.band(low, lower, ThemeColour.OUTSIDE)
    if high > upper:
        axes.band(upper, high, ThemeColour.OUTSIDE)


def _syncs(performance: Performance, chain: str) -> list[SyncTime]:
    """Sync points, in time, of the behaviours that move a chain."""
    plan = performance.plan
    part = PARTS.get(chain)
    return [sync for sync in plan.syncs if part in plan.keyframes.uses.get(sync.behaviour, frozenset())]


def _mark(axes: Axes, performance: Performance, syncs: list[SyncTime]) -> None:
    """Sync points as lines, strokes stronger; of many only the strokes."""
    zero = performance.plan.trajectory.zero
    for strong in (False, True) if len(syncs) <= MOST_LINES else (True,):
        times = [zero + sync.planned for sync in syncs if sync.is_stroke == strong]
        colour, width = (ThemeColour.FAINT, 0.9) if strong else (ThemeColour.GRID, 0.7)
        axes.verticals(times, colour, width=width)


def _label(axes: Axes, performance: Performance, syncs: list[SyncTime], width: float) -> None:
    """Names of behaviours over their strokes, as many as fit."""
    zero = performance.plan.trajectory.zero
    strokes = [sync for sync in syncs if sync.is_stroke]
    per_second = width / float(performance.measured.times[-1])
    for k in spaced_indices([sync.planned for sync in strokes], LABEL / per_second):
        label = fit_text(strokes[k].behaviour, LABEL)
        axes.write((zero + strokes[k].planned, 1.3), label, colour=ThemeColour.FAINT, place="time", align="center")
