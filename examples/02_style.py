"""Compare one gesture in two styles: extent and velocity of the hand."""

import numpy as np

from kinesic import Performer
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.metrics.arrival import compute_part_paths

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="g" lexeme="large" mode="BOTH_HANDS" start="0"/>
</bml>
"""

for name, extent in (("small and slow", -0.8), ("large and fast", 0.8)):
    style = Style.uniform(Expressivity(spatial=extent, temporal=extent), name)
    planned = Performer(style=style).plan(BML)
    times = np.arange(0.0, planned.trajectory.duration, 0.01)
    hand = compute_part_paths(planned.trajectory.sample(times)[0], planned.setup.robot)["l_hand"]
    velocity = np.linalg.norm(np.diff(hand, axis=0), axis=1) / 0.01
    print(f"{style.name}: {np.ptp(hand[:, 1]):.2f} m wide, at most {velocity.max():.2f} m/s")
