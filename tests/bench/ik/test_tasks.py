import subprocess
import sys

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench.ik.tasks import best_posture
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot

LEFT = Robot.load().arms["l"]


def test_positions_of_random_postures_are_met_to_the_nanometre():
    random = default_rng(91)
    for _ in range(20):
        position = LEFT.hand(random.uniform(LEFT.lower, LEFT.upper))
        found = best_posture(LEFT, Reach(position))
        assert np.all((LEFT.lower <= found.angles) & (found.angles <= LEFT.upper))
        assert np.linalg.norm(LEFT.hand(found.angles) - position) == pytest.approx(found.residual, abs=1e-12)
        assert found.residual < 1e-6
        assert found.pointing_error is None


def test_pointing_and_palm_are_met_too():
    random = default_rng(92)
    for _ in range(10):
        rotations, centres = LEFT.frames(random.uniform(LEFT.lower, LEFT.upper))
        found = best_posture(LEFT, Reach(centres[-2], centres[-1] - centres[-2], rotations[-1] @ LEFT.palm))
        assert found.residual < 1e-5
        assert found.pointing_error is not None
        assert found.palm_error is not None
        assert max(found.pointing_error, found.palm_error) < 1e-3


def test_beyond_reach_more_beginnings_are_never_worse_and_the_seed_decides():
    reach = Reach(np.array([-0.5, -0.3, 0.1]))
    few, many, again = (best_posture(LEFT, reach, beginnings=count, seed=3) for count in (2, 12, 12))
    assert many.residual <= few.residual + 1e-9
    assert many.beginnings == 12
    assert many.angles.tobytes() == again.angles.tobytes()


def test_the_room_is_imported_without_casadi():
    code = "import sys, kinesic.bench.ik.tasks; sys.exit('casadi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
