import numpy as np

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.seeds import SEED_COUNT, seeds
from kinesic.ik.scalar3 import distance

from ...reference.ik.multistart import nearest_seeds

ARM_CHAIN = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(ARM_CHAIN)  # linkage of the left arm


def test_ik_start_postures_cover_the_joint_ranges() -> None:
    angles = np.array([seed.angles for seed in seeds(ARM_LINKAGE)])
    shares = (angles - ARM_CHAIN.lower[:5]) / (ARM_CHAIN.upper[:5] - ARM_CHAIN.lower[:5])
    assert angles.shape == (SEED_COUNT, 5)
    assert np.all((shares >= 0.0) & (shares <= 1.0))
    for column in shares.T:
        assert np.all(np.histogram(column, bins=4, range=(0, 1))[0] >= SEED_COUNT // 8)


def test_ik_start_postures_are_cached_and_sorted_by_hand_distance_to_the_target() -> None:
    arm = linkage_of(ARM_CHAIN)
    assert seeds(arm) is seeds(arm)
    result = nearest_seeds(ARM_LINKAGE, (0.2, 0.1, 0.0), 5)
    spans = [distance(seed.hand, (0.2, 0.1, 0.0)) for seed in result]
    assert spans == sorted(spans)
    assert len(result) == 5
