"""Leaves a running motion for another one, and stops it: angles, speeds and accelerations go on without a step."""

import numpy as np

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.motion.stopping import stop
from kinesic.realizer.merge import replace_motion

CUT = 2.0  # [s]

performer = Performer()
running = performer.plan(CONFIGS / "bml" / "welcome.bml")
nod = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.6"/></bml>'
other = performer.plan(nod)

halted = stop(running.trajectory, CUT, performer.setup.limits)
print(f"at rest {1000 * (halted.duration - CUT):.0f} ms after the cut")

over = replace_motion(running.trajectory, CUT, other)
print(f"nods instead, {over.zero - CUT:.2f} s after the cut")

before, after = running.trajectory.at(CUT), over.trajectory.at(CUT)
for quantity in ("angles", "speeds", "accelerations"):
    step = np.abs(getattr(after, quantity) - getattr(before, quantity)).max()
    print(f"largest step of {quantity} at the cut: {step:.1e}")
