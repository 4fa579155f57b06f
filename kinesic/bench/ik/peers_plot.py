"""The other libraries as bars: how long one reach takes, and how many targets are reached."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kinesic.bench.ik.peer_solvers import PEERS

OURS = {"kinesic_reach": "kinesic, Arm.reach", "kinesic_solve": "kinesic, solve"}
COLOURS = {True: "#2b7a78", False: "#5b6fb5"}
INK = "#333333"
SMALL = 8.5  # [pt]


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draws the libraries that were measured.

    Args:
        values: figures by name, as `kinesic bench ik --json` lists them; others are ignored.
        path: of the picture, PNG.

    Returns:
        The path.
    """
    known = (*OURS, *(peer.name for peer in PEERS))
    names = [name for name in known if f"ik.peer_{name}_us" in values]
    labels = [OURS.get(name, name) for name in names]
    colours = [COLOURS[name in OURS] for name in names]
    figure = Figure(figsize=(11.0, 1.2 + 0.34 * len(names)), layout="constrained")
    FigureCanvasAgg(figure)
    time, share = figure.subplots(1, 2, sharey=True)
    medians = [values[f"ik.peer_{name}_us"] for name in names]
    shares = [100 * values[f"ik.peer_{name}_success"] for name in names]
    time.barh(labels, medians, color=colours)
    time.set_xscale("log")
    time.set_xlabel("median of one call [µs]", fontsize=SMALL, color=INK)
    share.barh(labels, shares, color=colours)
    share.set_xlim(90, 100.5)
    share.set_xlabel("targets below 1 mm [%]", fontsize=SMALL, color=INK)
    for row, (median, reached) in enumerate(zip(medians, shares, strict=True)):
        time.text(median, row, f" {median:.3g}", va="center", fontsize=SMALL, color=INK)
        share.text(reached, row, f" {reached:.1f}", va="center", fontsize=SMALL, color=INK)
    time.invert_yaxis()
    time.margins(x=0.15)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    return path
