"""Plots of margins over time: clearance, servo limits, contacts and tracking error."""

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.metrics.dry_run import DryRun
from kinesic.report.plots.axes import FIGURE_WIDTH, Figure, PlotAxes, ThemeColour
from kinesic.report.plots.fitting import thin_line

PANEL_HEIGHT = 1.35  # [in] height of a panel with its heading
BOTTOM_MARGIN = 0.3  # [in] margin below the panels
LEFT_MARGIN = 0.45  # [in] margin left of the panels
RIGHT_MARGIN = 0.1  # [in] margin right of the panels
DRAWN_REGIONS = ("hand", "chest")  # parts of a person whose contact force is drawn
HEADING_POSITION = 1.05  # y position of the heading, relative to the panel's height


def margins(performance: DryRun) -> Markup:
    """Draw clearance, limit ratios, contacts and tracking error over time."""
    contacts = () if performance.reference.impacts is None else (_contacts,)
    panels = (_clearance, _limit_ratios, *contacts, _tracking)
    drawn = Figure(PANEL_HEIGHT * len(panels) + BOTTOM_MARGIN)
    for row, panel in enumerate(panels):
        bottom = BOTTOM_MARGIN + PANEL_HEIGHT * (len(panels) - 1 - row)
        axes = drawn.axes(
            LEFT_MARGIN, bottom, FIGURE_WIDTH - LEFT_MARGIN - RIGHT_MARGIN, PANEL_HEIGHT - 0.25, timed=True
        )
        axes.limit_x(0.0, performance.duration)
        axes.labelled = row == len(panels) - 1
        panel(axes, performance)
    return drawn.svg()


def _clearance(axes: PlotAxes, performance: DryRun) -> None:
    """Draw the distance of the closest segments and the required clearance."""
    plan, measured = performance.plan, performance.measured
    least = 1000 * plan.setup.robot.min_clearance
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
    axes.write_heading("distance to the body [mm]", nearest, height=HEADING_POSITION)


def _limit_ratios(axes: PlotAxes, performance: DryRun) -> None:
    """Draw planned velocity, acceleration, jerk and duty relative to their limits.

    The largest ratio of all hinges is drawn.
    """
    limits, times = performance.plan.setup.limits, performance.measured.times
    speeds, accelerations = performance.reference.velocities, performance.reference.accelerations
    ratios_by_name = (
        ("speed", np.abs(speeds) / limits.speed, ThemeColour.PLANNED),
        ("acceleration", np.abs(accelerations) / limits.acceleration, ThemeColour.FAINT),
        ("jerk", np.abs(performance.plan.trajectory.jerks(times)) / limits.jerk, ThemeColour.ASKED),
        ("duty", np.abs(performance.reference.duties), ThemeColour.SPEECH),
    )
    for _, ratios, colour in ratios_by_name:
        axes.line(*thin_line(times, ratios.max(axis=1)), colour)
    top = max(1.1, *(1.05 * float(ratios.max()) for _, ratios, _ in ratios_by_name))
    axes.limit_y(0.0, top)
    axes.level(1.0, ThemeColour.FAIL)
    axes.band(1.0, top, ThemeColour.OUTSIDE)
    axes.write_heading("fraction of limit, worst hinge", "", height=HEADING_POSITION)
    for k, (name, ratios, colour) in enumerate(ratios_by_name):
        heading = _peak(name, ratios, performance)
        axes.write((1.0 - 0.21 * (3 - k), HEADING_POSITION), heading, colour=colour, align="right")


def _contacts(axes: PlotAxes, performance: DryRun) -> None:
    """Draw the contact forces on a free hand and chest.

    Under a policy, the lower of the limits of both is drawn.
    """
    figures = performance.reference.impacts
    assert figures is not None
    curves = [(region, ThemeColour.PLANNED if region == "hand" else ThemeColour.ASKED) for region in DRAWN_REGIONS]
    drawn = [(name, colour) for name, colour in curves if name in figures.regions]
    top = 1.0
    for name, colour in drawn:
        forces = figures.forces[:, figures.regions.index(name)]
        top = max(top, 1.05 * float(forces.max()))
        axes.line(*thin_line(figures.times, forces), colour)
    limits = {} if figures.policy is None else figures.policy.table.force
    limit = min((limits[name] for name, _ in drawn if name in limits), default=None)
    axes.limit_y(0.0, top if limit is None else max(top, 1.1 * limit))
    if limit is not None:
        axes.level(limit, ThemeColour.FAIL)
        axes.band(limit, axes.y_limits[1], ThemeColour.OUTSIDE)
    worst = [f"{name}: {figures.worst[name].value:.0f} N, {figures.worst[name].segment}" for name, _ in drawn]
    title = f"force of a contact with a free {' or '.join(name for name, _ in drawn)} [N], model"
    axes.write_heading(title, "; ".join(worst), height=HEADING_POSITION)


def _tracking(axes: PlotAxes, performance: DryRun) -> None:
    """Draw the largest tracking error of any joint.

    Grey includes joints that hardly move.
    """
    everything = np.degrees(np.abs(performance.measured.angles - performance.reference.angles))
    counted = np.where(performance.reference.moving, everything, 0.0)
    for errors, colour in ((everything, ThemeColour.ASKED), (counted, ThemeColour.PERFORMED)):
        axes.line(*thin_line(performance.measured.times, errors.max(axis=1)), colour)
    axes.limit_y(0.0)
    title = "tracking error of the twin, worst hinge [deg]; grey: with hinges that hardly move"
    axes.write_heading(title, _peak("while moving", counted, performance), height=HEADING_POSITION)


def _peak(name: str, values: Floats, performance: DryRun) -> str:
    hinge = performance.plan.setup.robot.skeleton.names[int(values.max(axis=0).argmax())]
    return f"{name}: {values.max():.2f}, {hinge}"
