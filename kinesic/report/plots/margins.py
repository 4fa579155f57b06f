"""How much room is left over time: distance to the body, share of the servos' limits, and tracking error."""

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.controller.performance import Performance
from kinesic.report.plots.axes import WIDTH, Axes, Figure, ThemeColour
from kinesic.report.plots.fitting import thin_line

PANEL, BOTTOM = 1.35, 0.3  # [in]
LEFT, RIGHT = 0.45, 0.1  # [in]
HEADING = 1.05  # share of a panel's height


def margins(performance: Performance) -> Markup:
    """Draws clearance, shares of limits and tracking error over performance time."""
    panels = (_clearance, _shares, _tracking)
    drawn = Figure(PANEL * len(panels) + BOTTOM)
    for row, panel in enumerate(panels):
        bottom = BOTTOM + PANEL * (len(panels) - 1 - row)
        axes = drawn.axes(LEFT, bottom, WIDTH - LEFT - RIGHT, PANEL - 0.25, timed=True)
        axes.limit_x(0.0, float(performance.measured.times[-1]))
        axes.labelled = row == len(panels) - 1
        panel(axes, performance)
    return drawn.svg()


def _clearance(axes: Axes, performance: Performance) -> None:
    """Distance of the closest pair of segments, with the least that is required."""
    plan, measured = performance.plan, performance.measured
    least = 1000 * plan.setup.robot.least_clearance
    curves = (
        (plan.clearance_times, plan.clearance, ThemeColour.PLANNED, False),
        (measured.times, measured.clearance, ThemeColour.PERFORMED, True),
    )
    for times, clearance, colour, dashed in curves:
        axes.line(*thin_line(times, 1000 * clearance.distances), colour, width=1.2, dashed=dashed)
    lowest = 1000 * min(float(clearance.distances.min()) for _, clearance, _, _ in curves)
    axes.limit_y(min(0.0, lowest - 5.0))
    axes.band(axes.y_limits[0], least, ThemeColour.OUTSIDE)
    axes.level(least, ThemeColour.FAIL)
    worst = measured.clearance.worst
    a, b = measured.clearance.pairs[worst]
    nearest = f"nearest: {a} and {b} at {measured.times[worst]:.2f} s"
    axes.head("distance to the body [mm]", nearest, height=HEADING)


def _shares(axes: Axes, performance: Performance) -> None:
    """The hinge that is nearest to its limit, of speed, acceleration, jerk and duty."""
    limits, times = performance.plan.setup.limits, performance.measured.times
    speeds, accelerations = performance.reference.speeds, performance.reference.accelerations
    shares = (
        ("speed", np.abs(speeds) / limits.speed, ThemeColour.PLANNED),
        ("acceleration", np.abs(accelerations) / limits.acceleration, ThemeColour.FAINT),
        ("jerk", np.abs(performance.plan.trajectory.jerks(times)) / limits.jerk, ThemeColour.ASKED),
        ("duty", np.abs(performance.reference.duties), ThemeColour.SPEECH),
    )
    for _, share, colour in shares:
        axes.line(*thin_line(times, share.max(axis=1)), colour)
    top = max(1.1, *(1.05 * float(share.max()) for _, share, _ in shares))
    axes.limit_y(0.0, top)
    axes.level(1.0, ThemeColour.FAIL)
    axes.band(1.0, top, ThemeColour.OUTSIDE)
    axes.head("share of limit, worst hinge", "", height=HEADING)
    for k, (name, share, colour) in enumerate(shares):
        axes.write((1.0 - 0.21 * (3 - k), HEADING), _peak(name, share, performance), colour=colour, align="right")


def _tracking(axes: Axes, performance: Performance) -> None:
    """Measured minus planned angle of the hinge that is furthest off; in grey also those that hardly move."""
    everything = np.degrees(np.abs(performance.measured.angles - performance.reference.angles))
    counted = np.where(performance.reference.moving, everything, 0.0)
    for errors, colour in ((everything, ThemeColour.ASKED), (counted, ThemeColour.PERFORMED)):
        axes.line(*thin_line(performance.measured.times, errors.max(axis=1)), colour)
    axes.limit_y(0.0)
    title = "tracking error of the twin, worst hinge [deg]; grey: with hinges that hardly move"
    axes.head(title, _peak("while moving", counted, performance), height=HEADING)


def _peak(name: str, values: Floats, performance: Performance) -> str:
    hinge = performance.plan.setup.robot.skeleton.names[int(values.max(axis=0).argmax())]
    return f"{name}: {values.max():.2f}, {hinge}"
