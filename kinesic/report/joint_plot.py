"""Plot of a performance: timeline of behaviours above the joint angles."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinesic.bml.block import Speech
from kinesic.body.config import ConfigError, suggestion
from kinesic.extras import install_extra
from kinesic.planning.captions import make_captions
from kinesic.planning.plan import Plan
from kinesic.report.labels import label
from kinesic.report.plots.fitting import fit_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from kinesic.report.run import Performance

DEFAULT_HINGE_COUNT = 4  # number of plotted hinges, those with the largest motion, if none are named
FIGURE_WIDTH = 10.0  # [in] width of the figure
TIMELINE_WIDTH = 8.8  # [in] width of the time axes within the figure
ROW_HEIGHT = 0.22  # [in] height of a behaviour's row in the timeline
PANEL_HEIGHT = 1.3  # [in] height of a hinge's panel
TIMELINE_MARGIN = 0.4  # [in] free height above and below the behaviours, in total
# Name, colour, dash style and line width [pt] of each curve.
LINE_STYLES = (("requested", "#b4bcc2", "-", 3.0), ("planned", "#1769c2", "-", 1.4), ("measured", "#d9660a", "--", 1.2))
SPEECH_COLOUR = "#6a4fb3"  # colour of spoken words
STROKE_COLOUR = "#1c2024"  # colour of strokes
BAR_HEIGHT = 0.6  # height of a behaviour's bar / height of its row


def draw_joint_plot(run: "Performance", hinges: Sequence[str] | None) -> tuple["Axes", ...]:
    """Draw timeline and joint angles of a performance with matplotlib.

    Args:
        run: performance.
        hinges: names of the hinges; None: those with the largest range of motion.

    Returns:
        The axes of the timeline, then one for each hinge.

    Raises:
        ConfigError: matplotlib is missing, or the robot has no such hinge.
    """
    try:
        from matplotlib import pyplot  # noqa: PLC0415 - optional and slow to import
    except ModuleNotFoundError as error:
        raise ConfigError(f"plot needs {error.name}: {install_extra('notebook')}") from None

    plan, times = run.plan, run.measured.times
    chosen = _choose_hinges(run, hinges)
    desired = plan.desired
    requested = desired.sample(times - plan.trajectory.zero + desired.zero)[0]
    curves = [np.degrees(angles) for angles in (requested, run.reference.angles, run.measured.angles)]
    rows = ROW_HEIGHT * len(plan.timeline.timed) + TIMELINE_MARGIN
    heights = [rows, *[PANEL_HEIGHT] * len(chosen)]
    _, drawn = pyplot.subplots(
        len(heights),
        sharex=True,
        squeeze=False,
        figsize=(FIGURE_WIDTH, sum(heights)),
        height_ratios=heights,
        layout="constrained",
    )
    axes: tuple[Axes, ...] = tuple(drawn[:, 0])
    _draw_timeline(axes[0], plan)
    strokes = [plan.trajectory.zero + sync.planned for sync in plan.syncs if sync.is_stroke]
    for panel, hinge in zip(axes[1:], chosen, strict=True):
        for curve, (name, colour, dashes, width) in zip(curves, LINE_STYLES, strict=True):
            panel.plot(times, curve[:, hinge], color=colour, linestyle=dashes, linewidth=width, label=name)
        panel.set_title(plan.setup.robot.skeleton.names[hinge], loc="left", fontsize="small")
        panel.set_ylabel("deg")
        for stroke in strokes:
            panel.axvline(stroke, color=STROKE_COLOUR, alpha=0.15, linewidth=0.8)
    if chosen:
        axes[1].legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, ncols=len(LINE_STYLES), fontsize="small"
        )
    axes[-1].set_xlabel("performance time [s]")
    axes[-1].set_xlim(0.0, run.duration)
    return axes


def _choose_hinges(run: "Performance", hinges: Sequence[str] | None) -> list[int]:
    """Return the indices of the hinges to draw.

    Raises:
        ConfigError: the robot has no such hinge.
    """
    names = run.plan.setup.robot.skeleton.names
    if hinges is None:
        travels = np.ptp(run.measured.angles, axis=0)
        return sorted(int(hinge) for hinge in np.argsort(-travels, kind="stable")[:DEFAULT_HINGE_COUNT])
    for hinge in hinges:
        if hinge not in names:
            raise ConfigError(f"robot {run.plan.setup.robot.name} has no hinge {hinge}{suggestion(hinge, names)}")
    return [names.index(hinge) for hinge in hinges]


def _draw_timeline(axes: "Axes", plan: Plan) -> None:
    """Draw behaviours with their strokes, and the spoken words."""
    zero, names = plan.trajectory.zero, []
    captions = list(make_captions(plan))
    for row, entry in enumerate(plan.timeline.timed):
        behaviour = entry.behaviour
        names.append(label(behaviour))
        if isinstance(behaviour.action, Speech):
            for caption in (caption for caption in captions if caption.behaviour == behaviour.id):
                span = [(caption.begin, caption.end - caption.begin)]
                axes.broken_barh(span, (row - BAR_HEIGHT / 2, BAR_HEIGHT), color=SPEECH_COLOUR, alpha=0.25)
                words = fit_text(caption.text, (caption.end - caption.begin) * TIMELINE_WIDTH / plan.duration)
                axes.text(caption.begin, row, f" {words}", fontsize="x-small", va="center", clip_on=True)
            continue
        syncs = [sync for sync in plan.syncs if sync.behaviour == behaviour.id]
        if not syncs:
            continue
        begin, end = (zero + extreme(sync.planned for sync in syncs) for extreme in (min, max))
        axes.broken_barh([(begin, end - begin)], (row - BAR_HEIGHT / 2, BAR_HEIGHT), color=LINE_STYLES[1][1], alpha=0.4)
        strokes = [zero + sync.planned for sync in syncs if sync.is_stroke]
        axes.vlines(strokes, row - BAR_HEIGHT / 2, row + BAR_HEIGHT / 2, color=STROKE_COLOUR, linewidth=1.5)
    axes.set_yticks(range(len(names)), names, fontsize="x-small")
    axes.set_ylim(max(len(names), 1) - 0.5, -0.5)
    axes.set_title(str(plan), loc="left", fontsize="small")
