import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.shoulder_elbow import place_of
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.arm.swivel_search import GIRDLE_STEPS, SWIVELS, cell_at, cells, present_swivel
from kinesic.ik.scalar3 import Rotation, vector

LEFT = Robot.load().arms["l"]
LINKAGE = linkage_of(LEFT)
POSTURE = np.array([0.1, 0.6, 0.4, -0.3, 1.2, 0.2, 0.1, -0.1])
TARGET = vector(LEFT.hand(POSTURE))


def _still(frame: Rotation) -> tuple[tuple[float, ...], float]:
    return (0.2, 0.1, -0.1), 0.0


def test_the_first_cell_is_the_present_posture():
    first = next(cells(LINKAGE, TARGET, _still, near=POSTURE.tolist()))
    assert first.angles == pytest.approx(POSTURE.tolist(), abs=1e-9)
    assert first.cost < 1e-9


def test_every_cell_is_inside_the_ranges_and_tells_its_miss():
    seen = list(cells(LINKAGE, TARGET, _still, near=POSTURE.tolist()))
    assert len(seen) == SWIVELS * (GIRDLE_STEPS + 1)
    for cell in seen:
        angles = np.array(cell.angles)
        assert np.all((LEFT.lower <= angles) & (angles <= LEFT.upper))
        assert cell.miss == pytest.approx(np.linalg.norm(LEFT.hand(angles) - TARGET), abs=1e-9)
    assert sum(cell.miss < 1e-9 for cell in seen) > SWIVELS


def test_without_the_girdle_the_collar_bone_stays():
    seen = list(cells(LINKAGE, TARGET, _still, near=POSTURE.tolist(), girdle=False))
    assert len(seen) == SWIVELS
    assert {round(cell.angles[0], 9) for cell in seen} == {0.1}


def test_a_cell_has_the_swivel_that_was_asked():
    place = place_of(LINKAGE, POSTURE.tolist(), TARGET)
    now = present_swivel(LINKAGE, POSTURE.tolist())
    cell = cell_at(LINKAGE, place, now + 0.2, _still, near=POSTURE.tolist())
    assert cell.miss < 1e-9
    assert swivel(LEFT, np.array(cell.angles)) == pytest.approx(now + 0.2, abs=1e-9)
