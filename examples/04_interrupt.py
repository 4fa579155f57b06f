"""Stop a running motion, or replace it by another without a step."""

import numpy as np

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.motion.stopping import stop
from kinesic.realizer.merge import replace_motion

CUT_TIME = 2.0  # [s] time of the interruption

performer = Performer()
running = performer.plan(CONFIGS / "bml" / "welcome.bml")
nod = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.6"/></bml>'
other = performer.plan(nod)

stopped = stop(running.trajectory, CUT_TIME, performer.setup.limits)
print(f"at rest {1000 * (stopped.duration - CUT_TIME):.0f} ms after the interruption")

merged = replace_motion(running.trajectory, CUT_TIME, other)
print(f"nods instead, {merged.zero - CUT_TIME:.2f} s after the interruption")

before, after = running.trajectory.at(CUT_TIME), merged.trajectory.at(CUT_TIME)
for quantity in ("angles", "velocities", "accelerations"):
    step = np.abs(getattr(after, quantity) - getattr(before, quantity)).max()
    print(f"largest step of {quantity} at the interruption: {step:.1e}")
