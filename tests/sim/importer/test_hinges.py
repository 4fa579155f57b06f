import numpy as np
import pytest

from kinesic.sim.importer.hinges import _find_axis_sign, name_hinges, spell_angle


@pytest.fixture(scope="module")
def hinges(tee_figure):
    return {hinge.name: hinge for hinge in name_hinges(tee_figure)}


def test_each_imported_hinge_gets_its_mpeg_4_bap_name(hinges, tee_figure):
    joints = {name: tee_figure.tree.joints[hinge.joint].name for name, hinge in hinges.items()}
    assert joints == {
        "vl5_torsion": "waist",
        "vl5_tilt": "bow",
        "skullbase_torsion": "pan",
        "skullbase_tilt": "nod",
        **{
            f"{side}_{name}": f"{side}_{joint}"
            for side in "lr"
            for name, joint in {
                "shoulder_flexion": "pitch",
                "shoulder_abduct": "roll",
                "shoulder_twisting": "twist",
                "elbow_flexion": "bend",
                "elbow_twisting": "turn",
                "wrist_flexion": "nod",
                "wrist_pivot": "wag",
            }.items()
        },
    }


def test_imported_joint_axes_have_the_directions_of_the_default_robot(hinges):
    expected = {"shoulder_flexion": (0, -1, 0), "shoulder_abduct": (1, 0, 0), "shoulder_twisting": (0, 0, 1)}
    expected |= {"elbow_flexion": (0, -1, 0), "wrist_flexion": (-1, 0, 0), "wrist_pivot": (0, 1, 0)}
    for name, (x, y, z) in expected.items():
        assert hinges[f"l_{name}"].axis == pytest.approx([x, y, z], abs=0.06)
        assert hinges[f"r_{name}"].axis == pytest.approx([-x, y, -z], abs=0.06)
    assert hinges["skullbase_tilt"].axis == pytest.approx([0, 1, 0])


def test_left_and_right_hinges_of_an_imported_robot_have_equal_ranges(hinges):
    for name, hinge in hinges.items():
        if name.startswith("l_"):
            image = hinges[f"r_{name[2:]}"]
            assert (hinge.lower, hinge.upper) == pytest.approx((image.lower, image.upper), abs=1e-3)


def test_imported_joint_ranges_are_relative_to_the_hanging_arm(hinges):
    abduct = hinges["l_shoulder_abduct"]
    assert np.degrees([abduct.lower, abduct.upper]) == pytest.approx(
        [90 - np.degrees(1.7), 90 + np.degrees(1.2)], abs=1
    )
    assert hinges["l_elbow_flexion"].lower < 0 < hinges["l_elbow_flexion"].upper
    assert not any(hinge.assumed for hinge in hinges.values())


def test_hinge_without_range_gets_an_anatomical_range(hanging_mapped):
    turn = next(hinge for hinge in hanging_mapped.hinges if hinge.name == "l_elbow_twisting")
    assert turn.assumed
    assert np.degrees([turn.lower, turn.upper]) == pytest.approx([-90, 90])
    assert any("l_elbow_twisting" in text for text in hanging_mapped.file.robot.imported.review)


def test_formula_of_an_original_joint_angle_is_written_as_text(hinges):
    assert spell_angle(hinges["l_shoulder_abduct"], "l_roll").startswith("l_roll = angle -")
    assert spell_angle(hinges["r_shoulder_abduct"], "r_roll").startswith("r_roll = -angle +")


@pytest.mark.parametrize(("name", "axis"), [("wrist_flexion", (0.1, 0.2, 0.9)), ("wrist_pivot", (0.9, 0.2, 0.1))])
def test_wrist_axis_in_an_unusual_direction_has_the_default_sign(name, axis):
    for side, sign in (("l", 1.0), ("r", -1.0)):
        assert _find_axis_sign(name, np.array(axis), side) == sign
        assert _find_axis_sign(name, -np.array(axis), side) == -sign
