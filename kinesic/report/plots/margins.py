"""How much room is left over time: distance to the body, share of the servos' limits, and tracking error."""

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.controller.performance import Performance
from kinesic.report.plots.svg import (
    DASHES,
    WIDTH,
    Colour,
    empty_figure,
    svg,
    thin_line,
    time_axes,
    write_heading,
    write_text,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANEL, TOP, BOTTOM = 1.35, 0.0, 0.3  # [in]
LEFT, RIGHT = 0.45, 0.1  # [in]
HEADING = 1.05  # share of a panel's height


def margins(performance: Performance) -> Markup:
    """Draws clearance, shares of limits and tracking error over performance time."""
    panels = (_clearance, _shares, _tracking)
    height = TOP + PANEL * len(panels) + BOTTOM
    drawn = empty_figure(height)
    for row, panel in enumerate(panels):
        bottom = (BOTTOM + PANEL * (len(panels) - 1 - row)) / height
        axes = drawn.add_axes((LEFT / WIDTH, bottom, 1 - (LEFT + RIGHT) / WIDTH, (PANEL - 0.25) / height))
        time_axes(axes, end=float(performance.measured.times[-1]))
        panel(axes, performance)
        if row < len(panels) - 1:
            axes.tick_params(labelbottom=False)
    return svg(drawn)


def _clearance(axes: "Axes", performance: Performance) -> None:
    """Distance of the closest pair of segments, with the least that is required."""
    plan, measured = performance.plan, performance.measured
    least = 1000 * plan.setup.robot.least_clearance
    curves = (
        (plan.clearance_times, plan.clearance, Colour.PLANNED, "-"),
        (measured.times, measured.clearance, Colour.PERFORMED, DASHES),
    )
    for times, clearance, colour, dashes in curves:
        axes.plot(*thin_line(times, 1000 * clearance.distances), color=colour, linewidth=1.2, linestyle=dashes)
    lowest = 1000 * min(float(clearance.distances.min()) for _, clearance, _, _ in curves)
    axes.set_ylim(min(0.0, lowest - 5.0), None)
    axes.axhspan(axes.get_ylim()[0], least, color=Colour.OUTSIDE, linewidth=0)
    axes.axhline(least, color=Colour.FAIL, linewidth=0.8)
    worst = measured.clearance.worst
    a, b = measured.clearance.pairs[worst]
    write_heading(
        axes, "distance to the body [mm]", f"nearest: {a} and {b} at {measured.times[worst]:.2f} s", height=HEADING
    )


def _shares(axes: "Axes", performance: Performance) -> None:
    """The hinge that is nearest to its limit, of speed, acceleration, jerk and duty."""
    limits, times = performance.plan.setup.limits, performance.measured.times
    speeds, accelerations = performance.reference.speeds, performance.reference.accelerations
    shares = (
        ("speed", np.abs(speeds) / limits.speed, Colour.PLANNED),
        ("acceleration", np.abs(accelerations) / limits.acceleration, Colour.FAINT),
        ("jerk", np.abs(performance.plan.trajectory.jerks(times)) / limits.jerk, Colour.ASKED),
        ("duty", np.abs(performance.reference.duties), Colour.SPEECH),
    )
    for _, share, colour in shares:
        axes.plot(*thin_line(times, share.max(axis=1)), color=colour, linewidth=1.1)
    top = max(1.1, *(1.05 * float(share.max()) for _, share, _ in shares))
    axes.set_ylim(0.0, top)
    axes.axhline(1.0, color=Colour.FAIL, linewidth=0.8)
    axes.axhspan(1.0, top, color=Colour.OUTSIDE, linewidth=0)
    write_heading(axes, "share of limit, worst hinge", "", height=HEADING)
    for k, (name, share, colour) in enumerate(shares):
        write_text(axes, (1.0 - 0.21 * (3 - k), HEADING), _peak(name, share, performance), colour=colour, align="right")


def _tracking(axes: "Axes", performance: Performance) -> None:
    """Measured minus planned angle of the hinge that is furthest off; in grey also those that hardly move."""
    everything = np.degrees(np.abs(performance.measured.angles - performance.reference.angles))
    counted = np.degrees(np.abs(np.nan_to_num(performance.errors)))
    for errors, colour in ((everything, Colour.ASKED), (counted, Colour.PERFORMED)):
        axes.plot(*thin_line(performance.measured.times, errors.max(axis=1)), color=colour, linewidth=1.1)
    axes.set_ylim(0.0, None)
    title = "tracking error of the twin, worst hinge [deg]; grey: with hinges that hardly move"
    write_heading(axes, title, _peak("while moving", counted, performance), height=HEADING)


def _peak(name: str, values: Floats, performance: Performance) -> str:
    hinge = performance.plan.setup.robot.skeleton.names[int(values.max(axis=0).argmax())]
    return f"{name}: {values.max():.2f}, {hinge}"
