"""Draw docs/pictures/expressivity-styles.png and expressivity-power.png: hand velocity of one gesture.

.venv/bin/python docs/make/stroke_figures.py
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from kinesic import Performer
from kinesic.bench.metric import INK_COLOUR, MAIN_COLOUR, OTHER_COLOUR, SECOND_COLOUR
from kinesic.body.arrays import Floats
from kinesic.sim.kinematics import compute_motion_frames

PICTURES_FOLDER = Path(__file__).resolve().parent.parent / "pictures"
DOCUMENT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="large"/></bml>'
SAMPLE_PERIOD = 0.01  # [s] time between two points of a curve
COLOURS = (SECOND_COLOUR, MAIN_COLOUR, OTHER_COLOUR)
DASHES = ("--", "-", "-.")


def compute_hand_velocity(performer: Performer) -> tuple[Floats, Floats]:
    """Return times [s] from strokeStart, and right wrist velocities [m/s]."""
    plan = performer.plan(DOCUMENT)
    times = np.arange(0.0, plan.duration, SAMPLE_PERIOD)
    origins = compute_motion_frames(performer.robot.skeleton, plan.trajectory.angles(times)).origins
    path = origins[performer.robot.arm("r").wrist].T
    velocity = np.linalg.norm(np.gradient(path, SAMPLE_PERIOD, axis=0), axis=1)
    return times - plan.trajectory.zero - plan.syncs["g:strokeStart"].planned, velocity


def draw(performers: Mapping[str, Performer], picture: str, span: tuple[float, float]) -> None:
    """Draw one velocity curve per performer over a time span [s]."""
    figure = Figure(figsize=(8.0, 2.8), layout="constrained", facecolor="white")
    axes = figure.subplots()
    for (name, performer), colour, dashes in zip(performers.items(), COLOURS, DASHES, strict=True):
        axes.plot(*compute_hand_velocity(performer), color=colour, linestyle=dashes, linewidth=2.0, label=name)
    top = 1.12 * axes.get_ylim()[1]
    axes.axvline(0.0, color=INK_COLOUR, linewidth=0.8, linestyle=":")
    axes.text(-0.02, top, "preparation", ha="right", va="top", fontsize=9)
    axes.text(0.02, top, "stroke, hold, return", va="top", fontsize=9)
    axes.set(xlabel="time since the stroke began [s]", ylabel="hand velocity [m/s]", xlim=span, ylim=(0.0, top))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="center right", frameon=False)
    figure.savefig(PICTURES_FOLDER / picture, dpi=100)


styles = {name: Performer(style=name, idle=0.0, variation=0.0) for name in ("sad", "neutral", "joyful")}
powers = {
    f"power {power:g}": Performer(settings=(f"power={power}",), idle=0.0, variation=0.0) for power in (-0.8, 0.0, 0.8)
}
draw(styles, "expressivity-styles.png", (-1.2, 3.2))
draw(powers, "expressivity-power.png", (-0.8, 2.2))
