import numpy as np
import pytest

from kinesic.sim.importer.arm import Split


def test_both_arms_hang_as_mirror_images(tee_figure):
    assert tee_figure.split == Split(0, 3, 3)
    assert tee_figure.asymmetry < 1e-3
    assert max(arm.off for arm in tee_figure.arms.values()) < np.radians(1)
    assert tee_figure.likeness > 3.0


def test_the_midline_is_at_zero(tee_figure):
    left, right = (tee_figure.arms[side].centres.shoulder for side in "lr")
    assert left[1] == pytest.approx(0.2, abs=1e-3)
    assert left[1] + right[1] == pytest.approx(0, abs=1e-9)


def test_the_arm_length_is_shoulder_to_wrist(tee_figure):
    assert tee_figure.arm_length == pytest.approx(0.52, abs=0.005)
