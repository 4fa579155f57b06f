import pytest

from kinesic.sim.importer.arm import Split, centres, likeness, splits
from kinesic.sim.importer.hinge_row import HingeRow


@pytest.fixture
def limb(tee):
    names = [joint.name for joint in tee.joints]
    return HingeRow.of(
        tee, [names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag")]
    )


def test_anatomical_division_of_imported_arm_hinges_has_the_highest_likeness_to_a_human_arm(limb):
    ranked = sorted(splits(7), key=lambda split: -likeness(limb, split))
    assert ranked[0] == Split(girdle=0, shoulder=3, wrist=3)
    assert likeness(limb, ranked[0]) > likeness(limb, ranked[1]) + 0.3


def test_imported_joint_centres_are_axis_intersections(limb):
    result = centres(limb, Split(0, 3, 3))
    assert result.shoulder == pytest.approx([0, 0.2, 1.45], abs=1e-3)
    assert result.elbow == pytest.approx([0.01, 0.48, 1.45], abs=1e-3)
    assert result.wrist == pytest.approx([0, 0.72, 1.45], abs=2e-3)
    assert result.miss == pytest.approx(0.0, abs=1e-3)
    assert result.lengths == pytest.approx((0.28, 0.24), abs=2e-3)


def test_arm_divisions_use_all_of_three_hinges_and_at_most_eight_of_nine():
    assert {split.hinges for split in splits(3)} == {3}
    assert all(split.hinges <= 8 for split in splits(9) if split.girdle + split.shoulder <= 4)
