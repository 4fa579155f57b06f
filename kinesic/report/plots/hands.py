"""Plots of hand paths, seen from the right, front and left."""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, PartName, Robot, Side
from kinesic.metrics.arrival import compute_part_paths
from kinesic.metrics.dry_run import DryRun
from kinesic.report.plots.axes import FIGURE_WIDTH, Figure, PlotAxes, ThemeColour

HAND_PARTS: dict[Side, PartName] = {"l": "l_hand", "r": "r_hand"}  # body part of each side's hand
VIEW_GAP = 0.5  # [in] gap between two views
TOP_MARGIN = 0.3  # [in] margin above the views
BOTTOM_MARGIN = 0.3  # [in] margin below the views
MAX_VIEW_HEIGHT = 4.6  # [in] largest height of the views
MAX_PATH_POINTS = 4000  # largest number of points drawn of a hand path
PLOT_MARGIN = 0.06  # [m] margin around the drawn paths


@dataclass(frozen=True)
class HandView:
    """Viewing direction of a hand path plot."""

    title: str
    across: int  # index of the horizontal coordinate
    mirrored: bool  # whether that coordinate grows to the left
    sides: tuple[Side, ...]  # hands shown


HAND_VIEWS = (
    HandView("right hand, from its right", 0, False, ("r",)),
    HandView("from the front", 1, False, SIDES),
    HandView("left hand, from its left", 0, True, ("l",)),
)


def hands(performance: DryRun) -> Markup:
    """Draw planned and performed hand paths over the robot at rest.

    Keys are dots.
    """
    robot = performance.plan.setup.robot
    planned = compute_part_paths(performance.reference.angles, robot)
    reference = {side: planned[HAND_PARTS[side]] for side in SIDES}
    keys = {side: _keys(performance, side) for side in SIDES}
    bones = _bones(robot)
    everything = np.concatenate([*reference.values(), *performance.measured.hands.values(), *keys.values(), *bones])
    low, high = everything.min(axis=0) - PLOT_MARGIN, everything.max(axis=0) + PLOT_MARGIN
    spans = [float((high - low)[view.across]) for view in HAND_VIEWS]
    scale = min(
        (FIGURE_WIDTH - VIEW_GAP * len(HAND_VIEWS)) / sum(spans), MAX_VIEW_HEIGHT / float((high - low)[2])
    )  # [in/m]
    tall = scale * float((high - low)[2])
    drawn = Figure(tall + TOP_MARGIN + BOTTOM_MARGIN)
    left = (FIGURE_WIDTH - scale * sum(spans) - VIEW_GAP * (len(HAND_VIEWS) - 1)) / 2 + VIEW_GAP / 4
    for view, span in zip(HAND_VIEWS, spans, strict=True):
        axes = drawn.axes(left, BOTTOM_MARGIN, scale * span, tall)
        left += scale * span + VIEW_GAP
        _frame(axes, view, low, high)
        for bone in bones:
            axes.line(bone[:, view.across], bone[:, 2], ThemeColour.GRID, width=3.0)
        for side in view.sides:
            _path(axes, view, reference[side], performance.measured.hands[side], keys[side])
    return drawn.svg()


def _frame(axes: PlotAxes, view: HandView, low: Floats, high: Floats) -> None:
    axes.ticks = 6
    span = (float(low[view.across]), float(high[view.across]))
    axes.limit_x(*(span[::-1] if view.mirrored else span))
    axes.limit_y(float(low[2]), float(high[2]))
    axes.write_heading(view.title, f"{'xyz'[view.across]}, z [m]", height=1.02)


def _path(axes: PlotAxes, view: HandView, planned: Floats, performed: Floats, keys: Floats) -> None:
    planned, performed = (path[:: len(path) // MAX_PATH_POINTS + 1] for path in (planned, performed))
    axes.line(planned[:, view.across], planned[:, 2], ThemeColour.PLANNED, width=1.2)
    axes.line(performed[:, view.across], performed[:, 2], ThemeColour.PERFORMED, width=1.0, dashed=True)
    axes.dots(keys[:, view.across], keys[:, 2], ThemeColour.ASKED, ThemeColour.PLANNED)


def _keys(performance: DryRun, side: Side) -> Floats:
    """Return the hand positions at the arm's key frames, (k, 3) [m]."""
    plan = performance.plan
    arm = plan.setup.robot.arm(side).joints
    keyed = [posture.angles for posture in plan.postures.postures if any(posture.keyed[joint] for joint in arm)]
    if not keyed:
        return np.zeros((0, 3))
    return compute_part_paths(np.stack(keyed), plan.setup.robot)[HAND_PARTS[side]]


def _bones(robot: Robot) -> list[Floats]:
    """Return lines (2, 3) [m] between neighbouring segments at rest."""
    origins = robot.skeleton.frames(robot.skeleton.rest).origins
    return [
        np.stack([origins[robot.skeleton.segment(segment.parent)], origins[k]])
        for k, segment in enumerate(robot.skeleton.segments)
        if segment.parent is not None
    ]
