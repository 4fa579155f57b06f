"""A picture of many results: a panel for each kind of them that a folder holds."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kinesic.body.config import ConfigError
from kinesic.tasks.store import Store

INK, FAINT, GOOD, BAD, OTHER = "#333333", "#8a8a8a", "#2b7a78", "#b3261e", "#d98e2b"
SMALL = 8.0  # [pt]
WIDTH, HEIGHT, ROW = 10.0, 4.2, 0.2  # [in] of the picture, of a panel at least, and of a row of bars
DPI = 110

CHECKS = """
SELECT name, quantile_cont(share, 0.05), quantile_cont(share, 0.5), quantile_cont(share, 0.95), max(share),
    bool_or(status = 'fail') FROM (SELECT name, status, "value" / "limit" AS share FROM checks WHERE "limit" > 0)
GROUP BY name ORDER BY max(share)
"""
SWEEP = "SELECT DISTINCT parameter, measure FROM sweep ORDER BY parameter"
FIGURES = "SELECT name, value / goal, ok FROM figures WHERE value > 0 AND goal > 0 ORDER BY value / goal"
DESIGNS = "SELECT price, lateness, mass, unbeaten, state FROM designs WHERE state <> 'out' AND price IS NOT NULL"


def draw_results(store: Store, path: Path) -> None:
    """Draws the results of a folder as a PNG.

    Args:
        store: of the results.
        path: of the picture.

    Raises:
        ConfigError: there is nothing of which a picture is known.
    """
    panels = [(draw, rows) for table, (draw, rows) in PANELS.items() if table in store.tables]
    if not panels:
        raise ConfigError(f"no picture of {', '.join(store.tables)} is known, of {', '.join(PANELS)} there is one")
    heights = [max(HEIGHT, ROW * rows(store)) for _, rows in panels]
    figure = Figure(figsize=(WIDTH, sum(heights)), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (draw, _) in zip(
        figure.subplots(len(panels), squeeze=False, height_ratios=heights)[:, 0], panels, strict=True
    ):
        draw(store, axes)
        axes.tick_params(labelsize=SMALL, labelcolor=INK, length=2)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.savefig(path, dpi=DPI, format="png", metadata={"Software": None})


def _draw_checks(store: Store, axes: Axes) -> None:
    """Each check over all documents as a share of its limit: 5 to 95 %, the median, and the largest."""
    rows = store.ask(CHECKS).rows
    shares = np.array([row[1:5] for row in rows], dtype=float).reshape(-1, 4)
    for height, (low, middle, high, most) in enumerate(shares):
        colour = BAD if rows[height][5] else GOOD
        axes.plot([low, high], [height, height], color=colour, linewidth=3.0, solid_capstyle="butt")
        axes.plot([middle], [height], color="white", marker="o", markersize=4, markeredgecolor=colour)
        axes.plot([most], [height], color=colour, marker="|", markersize=8)
    axes.axvline(1.0, color=FAINT, linewidth=0.8)
    axes.set_yticks(range(len(rows)), [str(row[0]) for row in rows])
    axes.set_xscale("symlog", linthresh=1.0)
    _name(axes, "checks of all documents: 5 to 95 %, median, largest; red: one failed", "value / limit", "")


def _draw_sweep(store: Store, axes: Axes) -> None:
    """Each parameter's own measure over its values, as a share of its largest."""
    for parameter, measure in store.ask(SWEEP).rows:
        name, column = str(parameter), str(measure).replace('"', "")
        query = (
            f'SELECT "value", "{column}" FROM sweep WHERE parameter = \'{name}\' AND "{column}" IS NOT NULL ORDER BY 1'
        )
        found = np.array(store.ask(query).rows, dtype=float).reshape(-1, 2)
        axes.plot(
            found[:, 0], found[:, 1] / max(np.abs(found[:, 1]).max(initial=0.0), 1e-12), "o-", label=f"{name}: {column}"
        )
    axes.legend(fontsize=SMALL, frameon=False)
    _name(axes, "each parameter's own measure", "value of the parameter", "measure / its largest")


def _draw_figures(store: Store, axes: Axes) -> None:
    """Each measured figure as a share of its goal."""
    rows = store.ask(FIGURES).rows
    shares = [float(str(row[1])) for row in rows]
    axes.barh(range(len(rows)), shares, color=[GOOD if row[2] else BAD for row in rows], height=0.7)
    axes.axvline(1.0, color=INK, linewidth=0.8)
    axes.set_yticks(range(len(rows)), [str(row[0]) for row in rows])
    axes.set_xlim(left=0.0)
    _name(axes, "figures beside their goals; red: missed", "value / goal", "")


def _draw_designs(store: Store, axes: Axes) -> None:
    """Lateness over price of each design that was weighed; the larger, the heavier."""
    rows = store.ask(DESIGNS).rows
    kinds = (("no other one beats it", GOOD, True), ("beaten, or left behind", FAINT, False))
    for label, colour, best in kinds:
        chosen = np.array([row[:3] for row in rows if bool(row[3]) is best], dtype=float).reshape(-1, 3)
        axes.scatter(chosen[:, 0], chosen[:, 1], s=12.0 * chosen[:, 2] ** 1.5, color=colour, alpha=0.7, label=label)
    axes.legend(fontsize=SMALL, frameon=False)
    _name(axes, "designs; the larger, the heavier", "price of the servos [US$]", "lateness of strokes, mean [ms]")


def _name(axes: Axes, title: str, across: str, up: str) -> None:
    axes.set_title(title, fontsize=10, color=INK, loc="left")
    axes.set_xlabel(across, fontsize=SMALL, color=INK)
    axes.set_ylabel(up, fontsize=SMALL, color=INK)


def _rows_of(query: str) -> Callable[[Store], int]:
    return lambda store: len(store.ask(query).rows)


PANELS: Mapping[str, tuple[Callable[[Store, Axes], None], Callable[[Store], int]]] = {
    "checks": (_draw_checks, _rows_of(CHECKS)),
    "sweep": (_draw_sweep, _rows_of(SWEEP)),
    "figures": (_draw_figures, _rows_of(FIGURES)),
    "designs": (_draw_designs, lambda store: 0),
}
