"""Draw docs/pictures/ik-thesis.png: relaxation of the masses of the thesis, and two arms on one torso."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from kinesic.body.robot import Robot
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.limbs import Limbs
from kinesic.ik.thesis.several import solve_several
from kinesic.ik.thesis.solve import RELAXATION_METHODS
from kinesic.ik.thesis.task import Effort, Task

mpl.use("Agg")
from matplotlib import pyplot as plt

CHAIN, TARGET = BallChain.curved(np.full(6, 1.0 / 6.0)), np.array([0.35, 0.0, -0.45])
TITLES = {
    "force": "method 1: an outer force draws the hand",
    "position": "method 2: the hand is pinned",
    "direct": "the same springs, all at once",
}

figure, panels = plt.subplots(1, 4, figsize=(15, 4), layout="constrained")
for panel, (method, relax) in zip(panels, RELAXATION_METHODS.items(), strict=False):
    last = relax(Task(CHAIN.points, TARGET, CHAIN.lengths, CHAIN.stiffness, CHAIN.masses, None, Effort())).iterations
    for step in sorted({0, 1, 2, 4, 8, last} & set(range(last + 1))):
        effort = Effort(iterations=step)
        masses = relax(Task(CHAIN.points, TARGET, CHAIN.lengths, CHAIN.stiffness, CHAIN.masses, None, effort)).points
        shade = str(0.85 - 0.85 * np.sqrt(step / last))
        panel.plot(masses[:, 0], masses[:, 2], "o-", color=shade, markersize=3, label=f"{step}")
    panel.plot(*TARGET[[0, 2]], "r+", markersize=14)
    panel.set(title=TITLES[method], aspect="equal")
    panel.legend(title="iteration", fontsize="small")

targets = {"l_arm": np.array([0.30, 0.28, 1.10]), "r_arm": np.array([0.35, -0.05, 0.75])}
for name, stance in solve_several(Limbs.of_robot(Robot.load("upper22")), targets).stances.items():
    panels[3].plot(stance.points[:, 1], stance.points[:, 2], "o-", label=name)
panels[3].plot([t[1] for t in targets.values()], [t[2] for t in targets.values()], "r+", markersize=14)
panels[3].set(title="both hands and the torso", aspect="equal", xlabel="left [m]", ylabel="up [m]")
panels[3].invert_xaxis()
panels[3].legend(fontsize="small")
figure.savefig(Path(__file__).parents[1] / "pictures" / "ik-thesis.png", dpi=80)
