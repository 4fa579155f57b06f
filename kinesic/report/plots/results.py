"""Overview picture of benchmark results in a folder."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kinesic.body.config import ConfigError
from kinesic.report.checks.check import CHECK_LIMITS
from kinesic.tasks.store import Store

INK_COLOUR = "#333333"  # colour of texts and axes
FAINT_COLOUR = "#8a8a8a"  # colour of secondary lines
GOOD_COLOUR = "#2b7a78"  # colour of values within their limits
BAD_COLOUR = "#b3261e"  # colour of values beyond their limits
FONT_SIZE = 8.0  # [pt] size of labels and legends
PICTURE_WIDTH = 10.0  # [in] width of the picture
MIN_PANEL_HEIGHT = 4.2  # [in] height of the smallest panel
ROW_HEIGHT = 0.2  # [in] height of a row of bars
PICTURE_DPI = 110  # [dots/in] resolution of the PNG

MAX_RATIO = 100.0  # largest drawn limit / value of a minimum; larger ratios are clipped
# Names of the checks whose limit is a minimum, as an SQL list.
MINIMUM_CHECKS = ", ".join(f"'{name}'" for name, limit in CHECK_LIMITS.items() if limit.at_least)
# The ratio is value / limit, or limit / value if the limit is a minimum: above 1, the limit is violated.
RATIO_LABEL = "value / {0}, or {0} / value of a minimum; right of 1: beyond the {0}"  # axis label; {0}: limit or goal
# Quantiles of value / limit of each check, and whether any document failed the check.
CHECKS_QUERY = f"""
SELECT name, quantile_cont(ratio, 0.05), quantile_cont(ratio, 0.5), quantile_cont(ratio, 0.95), max(ratio),
    bool_or(status = 'fail') FROM (SELECT name, status, CASE WHEN name IN ({MINIMUM_CHECKS})
    THEN "limit" / greatest("value", "limit" / {MAX_RATIO}) ELSE "value" / "limit" END AS ratio
    FROM checks WHERE "limit" > 0)
GROUP BY name ORDER BY max(ratio)
"""
SWEEP_QUERY = "SELECT DISTINCT parameter, measure FROM sweep ORDER BY parameter"
# Value / goal of each metric (goal / value if higher is better), and whether the metric meets the goal.
METRICS_QUERY = """
SELECT name, CASE WHEN better = 'higher' THEN goal / value ELSE value / goal END AS ratio, ok
FROM figures WHERE value > 0 AND goal > 0 ORDER BY ratio
"""
DESIGNS_QUERY = "SELECT price, lateness, mass, unbeaten, state FROM designs WHERE state <> 'out' AND price IS NOT NULL"


def draw_results(store: Store, path: Path) -> None:
    """Draw the results of a folder as a PNG.

    Args:
        store: store of the results.
        path: path of the picture.

    Raises:
        ConfigError: no result in the store has a picture.
    """
    panels = [(draw, rows) for table, (draw, rows) in RESULT_PANELS.items() if table in store.tables]
    if not panels:
        raise ConfigError(
            f"no picture of {', '.join(store.tables)} is known, of {', '.join(RESULT_PANELS)} there is one"
        )
    heights = [max(MIN_PANEL_HEIGHT, ROW_HEIGHT * rows(store)) for _, rows in panels]
    figure = Figure(figsize=(PICTURE_WIDTH, sum(heights)), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (draw, _) in zip(
        figure.subplots(len(panels), squeeze=False, height_ratios=heights)[:, 0], panels, strict=True
    ):
        draw(store, axes)
        axes.tick_params(labelsize=FONT_SIZE, labelcolor=INK_COLOUR, length=2)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.savefig(path, dpi=PICTURE_DPI, format="png", metadata={"Software": None})


def _draw_checks(store: Store, axes: Axes) -> None:
    """Draw quantiles, median and maximum of each check, relative to limits."""
    rows = store.ask(CHECKS_QUERY).rows
    shares = np.array([row[1:5] for row in rows], dtype=float).reshape(-1, 4)
    for height, (low, middle, high, most) in enumerate(shares):
        colour = BAD_COLOUR if rows[height][5] else GOOD_COLOUR
        axes.plot([low, high], [height, height], color=colour, linewidth=3.0, solid_capstyle="butt")
        axes.plot([middle], [height], color="white", marker="o", markersize=4, markeredgecolor=colour)
        axes.plot([most], [height], color=colour, marker="|", markersize=8)
    axes.axvline(1.0, color=FAINT_COLOUR, linewidth=0.8)
    axes.set_yticks(range(len(rows)), [str(row[0]) for row in rows])
    axes.set_xscale("symlog", linthresh=1.0)
    _name(axes, "checks of all documents: 5 to 95 %, median, largest; red: one failed", RATIO_LABEL.format("limit"), "")


def _draw_sweep(store: Store, axes: Axes) -> None:
    """Draw each swept parameter's measure relative to its maximum."""
    for parameter, measure in store.ask(SWEEP_QUERY).rows:
        name, column = str(parameter), str(measure).replace('"', "")
        query = (
            f'SELECT "value", "{column}" FROM sweep WHERE parameter = \'{name}\' AND "{column}" IS NOT NULL ORDER BY 1'
        )
        rows = np.array(store.ask(query).rows, dtype=float).reshape(-1, 2)
        axes.plot(
            rows[:, 0], rows[:, 1] / max(np.abs(rows[:, 1]).max(initial=0.0), 1e-12), "o-", label=f"{name}: {column}"
        )
    axes.legend(fontsize=FONT_SIZE, frameon=False)
    _name(axes, "each parameter's own measure", "value of the parameter", "measure / its largest")


def _draw_figures(store: Store, axes: Axes) -> None:
    """Draw each metric relative to its goal."""
    rows = store.ask(METRICS_QUERY).rows
    shares = [float(str(row[1])) for row in rows]
    axes.barh(range(len(rows)), shares, color=[GOOD_COLOUR if row[2] else BAD_COLOUR for row in rows], height=0.7)
    axes.axvline(1.0, color=INK_COLOUR, linewidth=0.8)
    axes.set_yticks(range(len(rows)), [str(row[0]) for row in rows])
    axes.set_xlim(left=0.0)
    _name(axes, "metrics relative to their goals; red: missed", RATIO_LABEL.format("goal"), "")


def _draw_designs(store: Store, axes: Axes) -> None:
    """Draw lateness over price of robot designs, dot size showing mass."""
    rows = store.ask(DESIGNS_QUERY).rows
    kinds = (("Pareto-optimal", GOOD_COLOUR, True), ("dominated or eliminated", FAINT_COLOUR, False))
    for label, colour, best in kinds:
        chosen = np.array([row[:3] for row in rows if bool(row[3]) is best], dtype=float).reshape(-1, 3)
        axes.scatter(chosen[:, 0], chosen[:, 1], s=12.0 * chosen[:, 2] ** 1.5, color=colour, alpha=0.7, label=label)
    axes.legend(fontsize=FONT_SIZE, frameon=False)
    _name(
        axes, "designs; a larger dot is a heavier robot", "price of the servos [US$]", "lateness of strokes, mean [ms]"
    )


def _name(axes: Axes, title: str, across: str, up: str) -> None:
    axes.set_title(title, fontsize=10, color=INK_COLOUR, loc="left")
    axes.set_xlabel(across, fontsize=FONT_SIZE, color=INK_COLOUR)
    axes.set_ylabel(up, fontsize=FONT_SIZE, color=INK_COLOUR)


def _rows_of(query: str) -> Callable[[Store], int]:
    return lambda store: len(store.ask(query).rows)


RESULT_PANELS: Mapping[str, tuple[Callable[[Store, Axes], None], Callable[[Store], int]]] = {
    "checks": (_draw_checks, _rows_of(CHECKS_QUERY)),
    "sweep": (_draw_sweep, _rows_of(SWEEP_QUERY)),
    "figures": (_draw_figures, _rows_of(METRICS_QUERY)),
    "designs": (_draw_designs, lambda store: 0),
}
