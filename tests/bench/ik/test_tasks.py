import subprocess
import sys

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench.ik.tasks import best_posture
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot

LEFT_ARM = Robot.load().arms["l"]


def test_best_posture_search_reaches_hand_positions_of_random_postures():
    random = default_rng(91)
    for _ in range(20):
        position = LEFT_ARM.hand(random.uniform(LEFT_ARM.lower, LEFT_ARM.upper))
        best = best_posture(LEFT_ARM, Reach(position))
        assert np.all((LEFT_ARM.lower <= best.angles) & (best.angles <= LEFT_ARM.upper))
        assert np.linalg.norm(LEFT_ARM.hand(best.angles) - position) == pytest.approx(best.residual, abs=1e-12)
        assert best.residual < 1e-6
        assert best.pointing_error is None


def test_best_posture_search_meets_pointing_and_palm_directions():
    random = default_rng(92)
    for _ in range(10):
        rotations, centres = LEFT_ARM.frames(random.uniform(LEFT_ARM.lower, LEFT_ARM.upper))
        best = best_posture(LEFT_ARM, Reach(centres[-2], centres[-1] - centres[-2], rotations[-1] @ LEFT_ARM.palm))
        assert best.residual < 1e-5
        assert best.pointing_error is not None
        assert best.palm_error is not None
        assert max(best.pointing_error, best.palm_error) < 1e-3


def test_best_posture_search_with_more_starts_is_no_worse_and_repeatable_by_seed():
    reach = Reach(np.array([-0.5, -0.3, 0.1]))
    few, many, again = (best_posture(LEFT_ARM, reach, starts=count, seed=3) for count in (2, 12, 12))
    assert many.residual <= few.residual + 1e-9
    assert many.starts == 12
    assert many.angles.tobytes() == again.angles.tobytes()


def test_import_of_the_ik_task_benchmark_does_not_load_casadi():
    code = "import sys, kinesic.bench.ik.tasks; sys.exit('casadi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
