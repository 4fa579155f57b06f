"""Goals on the wire against where servos with profiles then are."""

from math import inf

import numpy as np
import pytest

from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import USUAL
from kinesic.hardware.virtual.set_point import by_speed

PERIOD = USUAL.period
STARTING = 3  # cycles


@pytest.fixture
def manifest(robot) -> Manifest:
    return Manifest.of(robot)


@pytest.fixture
def steering(manifest) -> GoalSteering:
    """All joints at zero."""
    made = GoalSteering(manifest, USUAL)
    made.put(range(len(manifest.members)), manifest.scale.nearest(np.zeros(len(manifest.members))))
    return made


@pytest.mark.parametrize("share", [-0.8, 0.2, 0.5, 0.8])
def test_set_points_of_moving_servos_are_at_their_goals_on_the_mean(manifest, steering, share):
    limit = manifest.speeds[0]  # [ticks/s] of the profile
    speed = share * manifest.members[0].speed / abs(manifest.scale.turns[0])
    for k in range(40):
        assert steering.player.take(k * PERIOD, np.full(len(manifest.rest), k * PERIOD * speed))
    steering.player.follow()
    place, off = float(steering.goals[0]), []
    for _ in range(10):
        steering.move(PERIOD, steering.goals, target=1.0, slow=0.4)
        profile = by_speed(place, 0.0, float(steering.ticks()[0]), limit=limit, acceleration=inf)
        places = [profile.at(time)[0] for time in np.arange(0.5, 100) * PERIOD / 100]
        off.append(np.mean(places) - steering.goals[0])
        place = profile.at(PERIOD)[0]
    assert np.abs(off[STARTING:]).max() < 1.5


def test_standing_servos_are_told_their_goals(steering):
    assert steering.ticks().tolist() == np.rint(steering.goals).tolist()
