"""Draw docs/pictures/certificate.png: desired and certified motion of the elbow in the example of its page.

.venv/bin/python docs/make/certificate_figure.py
"""

import re
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from kinesic import Performer
from kinesic.bench.metric import INK_COLOUR, MAIN_COLOUR, SECOND_COLOUR

DOCS_FOLDER = Path(__file__).resolve().parent.parent
PAGE = DOCS_FOLDER / "explanation" / "certificate.md"
PICTURE_FILE = DOCS_FOLDER / "pictures" / "certificate.png"
JOINT = "l_elbow_flexion"
STROKE_TIME = 0.4  # [s] stroke time that the document requests
SHOWN_TIMES = np.arange(-0.2, 0.6, 0.002)  # [s] block times at which the curves are drawn

document = re.findall(r"```xml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
plan = Performer("upper22").plan(document)
hinge, limits = plan.setup.robot.skeleton.names.index(JOINT), plan.setup.limits
motions = {
    "desired": (plan.desired.sample(SHOWN_TIMES + plan.desired.zero), SECOND_COLOUR, "--"),
    "certified": (plan.trajectory.sample(SHOWN_TIMES + plan.trajectory.zero), MAIN_COLOUR, "-"),
}

figure = Figure(figsize=(8.0, 3.0), layout="constrained", facecolor="white")
angle_axes, duty_axes = figure.subplots(1, 2)
for name, ((angles, velocities, accelerations), colour, dashes) in motions.items():
    duties = limits.inertial[hinge] * accelerations[:, hinge] + limits.viscous[hinge] * velocities[:, hinge]
    for axes, values in ((angle_axes, np.degrees(angles[:, hinge])), (duty_axes, 100.0 * duties)):
        axes.plot(SHOWN_TIMES, values, color=colour, linestyle=dashes, linewidth=2.0, label=name)
duty_limit = 100.0 * limits.duty[hinge]
duty_axes.axhspan(-duty_limit, duty_limit, color=INK_COLOUR, alpha=0.1, linewidth=0.0)
duty_axes.text(0.59, duty_limit + 5.0, f"limit: {duty_limit:.0f} %", ha="right", fontsize=9)
angle_axes.axvline(STROKE_TIME, color=INK_COLOUR, linewidth=0.8, linestyle=":")
angle_axes.text(STROKE_TIME + 0.01, 26.0, "stroke", fontsize=9)
angle_axes.set(title="angle of the left elbow", xlabel="time [s]", ylabel="degrees")
duty_axes.set(title="motor power that this motion needs", xlabel="time [s]", ylabel="% of full power")
angle_axes.legend(loc="center right", frameon=False)
for axes in (angle_axes, duty_axes):
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlim(SHOWN_TIMES[0], SHOWN_TIMES[-1])
figure.savefig(PICTURE_FILE, dpi=100)
