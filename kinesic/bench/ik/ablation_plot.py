"""The solver at work on one target, and what is left of it without some of its stages."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kinesic.bench.ik.ablation import ROWS, Arm, Row, masses, name
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.shoulder_elbow import EXACT, placed
from kinesic.ik.arm.swivel import elbow_at
from kinesic.ik.scalar3 import Vector
from kinesic.ik.solve import solve

TARGET = (0.075, -0.064, 0.164)  # [m] of the hand, in the frame of the chain's base
SWIVELS = 73
WORDS: dict[Row, str] = {
    "masses_guess": "masses, one guess each",
    "masses_branches": "masses, all branches",
    "circle": "elbow's circle",
    "masses_guess_polish": "masses, one guess, LM",
    "masses_branches_polish": "masses, branches, LM",
    "masses_branches_polish_seeds": "masses, branches, LM, seeds",
    "polish": "LM alone",
    "polish_seeds": "LM, seeds",
    "whole": "the whole solver",
}
SPRINGS, STOPPED, FOUND, TARGETS, PALE, INK = "#2b7a78", "#d98e2b", "#5b6fb5", "#b3261e", "#bbbbbb", "#333333"
SMALL = 8.5  # [pt]


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draws one target's solution in two views, and the ablation.

    Args:
        values: figures by name, those of `ablation.bench` among them.
        path: of the picture, PNG.

    Returns:
        The path.

    Raises:
        KeyError: a figure of the ablation is missing.
    """
    chain = Robot.load().arms["l"]
    arm = Arm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    figure = Figure(figsize=(12.5, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    first, second, third = figure.subplots(1, 3, width_ratios=[1.0, 1.0, 1.1])
    _masses(first, arm)
    _circle(second, arm)
    _bars(third, values)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    return path


def _masses(axes: Axes, arm: Arm) -> None:
    """From rest to the masses, and what the hinges make of those."""
    ends = masses(arm, TARGET)
    held = extract(arm.linkage, ends, arm.rest).angles
    _line(axes, _posture(arm, arm.rest), PALE, "at rest")
    _line(axes, (arm.linkage.origin, *ends), SPRINGS, "masses and springs")
    _line(axes, _posture(arm, held), STOPPED, "their hinges, inside the ranges")
    _dressed(axes, "masses know no ranges")


def _circle(axes: Axes, arm: Arm) -> None:
    """The elbow's circle, the part that the ranges allow, and the answer."""
    place = placed(arm.linkage, TARGET, near=arm.rest, rest=arm.rest)
    circle = [
        elbow_at(arm.linkage, place.shoulder, place.target, swivel) for swivel in np.linspace(-np.pi, np.pi, SWIVELS)
    ]
    allowed = [
        elbow
        for elbow in circle
        if extract(arm.linkage, (*place.girdle, elbow, place.target), arm.rest).miss <= EXACT * arm.linkage.farthest
    ]
    axes.plot([y for _, y, _ in circle], [z for _, _, z in circle], color=PALE, label="elbow's circle")
    axes.plot([y for _, y, _ in allowed], [z for _, _, z in allowed], ".", color=SPRINGS, label="inside the ranges")
    found = solve(arm.chain, Reach(np.array(TARGET)), start=arm.chain.rest)
    _line(axes, _posture(arm, found.angles.tolist()), FOUND, "the answer")
    _dressed(axes, "the nearest elbow that the ranges allow")


def _bars(axes: Axes, values: Mapping[str, float]) -> None:
    """Shares of targets below 1 mm."""
    for row, key in enumerate(ROWS):
        share = 100.0 * values[name(key, "mm")]
        axes.barh(-row, share, height=0.66, color=FOUND if key == "whole" else SPRINGS, zorder=2)
        axes.text(share - 1.0, -row, f"{share:.1f}", ha="right", va="center", fontsize=SMALL, color="white")
    axes.set_yticks([-row for row in range(len(ROWS))], [WORDS[key] for key in ROWS])
    axes.set_xlim(0.0, 100.0)
    axes.set_title("targets below 1 mm [%]", fontsize=10, color=INK)
    axes.tick_params(labelsize=SMALL, length=2)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _posture(arm: Arm, angles: Sequence[float]) -> list[Vector]:
    return arm.linkage.walk(angles, len(arm.linkage.links) - 1)[1]


def _line(axes: Axes, points: Sequence[Vector], colour: str, label: str) -> None:
    """Joints from the front: y to the left, z up [m]."""
    axes.plot([y for _, y, _ in points], [z for _, _, z in points], "o-", color=colour, markersize=4, label=label)


def _dressed(axes: Axes, title: str) -> None:
    axes.plot(TARGET[1], TARGET[2], "+", color=TARGETS, markersize=14, zorder=5, label="target")
    axes.set_title(title, fontsize=10, color=INK)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_xaxis()
    axes.set_xlabel("left [m], seen from the front", fontsize=SMALL)
    axes.set_ylabel("up [m]", fontsize=SMALL)
    axes.tick_params(labelsize=SMALL, length=2)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=SMALL, frameon=False)
