"""The paths of the hands in three views that share their height: from the robot's right, the front, and its left."""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, PartName, Robot, Side
from kinesic.controller.arrival import part_paths
from kinesic.controller.performance import Performance
from kinesic.report.plots.axes import WIDTH, Axes, Figure, ThemeColour

HANDS: dict[Side, PartName] = {"l": "l_hand", "r": "r_hand"}
GAP, TOP, BOTTOM = 0.5, 0.3, 0.3  # [in]
TALLEST = 4.6  # [in] of the views
MOST_POINTS = 4000  # of a path
PLOT_ROOM = 0.06  # [m] about what is drawn


@dataclass(frozen=True)
class HandView:
    """How the body is looked at."""

    title: str
    across: int  # the coordinate that runs across
    mirrored: bool  # it grows to the left
    sides: tuple[Side, ...]  # hands shown


VIEWS = (
    HandView("right hand, from its right", 0, False, ("r",)),
    HandView("from the front", 1, False, SIDES),
    HandView("left hand, from its left", 0, True, ("l",)),
)


def hands(performance: Performance) -> Markup:
    """Draws planned and performed paths of both hands, keys as dots, over the robot at rest."""
    robot = performance.plan.setup.robot
    planned = part_paths(performance.reference.angles, robot)
    reference = {side: planned[HANDS[side]] for side in SIDES}
    keys = {side: _keys(performance, side) for side in SIDES}
    bones = _bones(robot)
    everything = np.concatenate([*reference.values(), *performance.measured.hands.values(), *keys.values(), *bones])
    low, high = everything.min(axis=0) - PLOT_ROOM, everything.max(axis=0) + PLOT_ROOM
    spans = [float((high - low)[view.across]) for view in VIEWS]
    scale = min((WIDTH - GAP * len(VIEWS)) / sum(spans), TALLEST / float((high - low)[2]))  # [in/m]
    tall = scale * float((high - low)[2])
    drawn = Figure(tall + TOP + BOTTOM)
    left = (WIDTH - scale * sum(spans) - GAP * (len(VIEWS) - 1)) / 2 + GAP / 4
    for view, span in zip(VIEWS, spans, strict=True):
        axes = drawn.axes(left, BOTTOM, scale * span, tall)
        left += scale * span + GAP
        _frame(axes, view, low, high)
        for bone in bones:
            axes.line(bone[:, view.across], bone[:, 2], ThemeColour.GRID, width=3.0)
        for side in view.sides:
            _path(axes, view, reference[side], performance.measured.hands[side], keys[side])
    return drawn.svg()


def _frame(axes: Axes, view: HandView, low: Floats, high: Floats) -> None:
    axes.ticks = 6
    span = (float(low[view.across]), float(high[view.across]))
    axes.limit_x(*(span[::-1] if view.mirrored else span))
    axes.limit_y(float(low[2]), float(high[2]))
    axes.head(view.title, f"{'xyz'[view.across]}, z [m]", height=1.02)


def _path(axes: Axes, view: HandView, planned: Floats, performed: Floats, keys: Floats) -> None:
    planned, performed = (path[:: len(path) // MOST_POINTS + 1] for path in (planned, performed))
    axes.line(planned[:, view.across], planned[:, 2], ThemeColour.PLANNED, width=1.2)
    axes.line(performed[:, view.across], performed[:, 2], ThemeColour.PERFORMED, width=1.0, dashed=True)
    axes.dots(keys[:, view.across], keys[:, 2], ThemeColour.ASKED, ThemeColour.PLANNED)


def _keys(performance: Performance, side: Side) -> Floats:
    """(k, 3) [m] the hand at the keys of its arm."""
    plan = performance.plan
    arm = plan.setup.robot.arm(side).joints
    keyed = [posture.angles for posture in plan.postures.postures if any(posture.keyed[joint] for joint in arm)]
    if not keyed:
        return np.zeros((0, 3))
    return part_paths(np.stack(keyed), plan.setup.robot)[HANDS[side]]


def _bones(robot: Robot) -> list[Floats]:
    """Lines (2, 3) [m] from segment to segment, at rest."""
    origins = robot.skeleton.frames(robot.skeleton.rest).origins
    return [
        np.stack([origins[robot.skeleton.segment(segment.parent)], origins[k]])
        for k, segment in enumerate(robot.skeleton.segments)
        if segment.parent is not None
    ]
