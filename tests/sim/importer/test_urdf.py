from kinesic.sim.importer.urdf import urdf_joints


def test_speeds_and_mimics_that_mujoco_drops(hanging_path):
    joints = urdf_joints(hanging_path)
    assert joints["left_elbow_joint"].speed == 3.5
    assert joints["left_mimic_joint"].mimics
    assert not joints["left_grip_joint"].mimics


def test_an_mjcf_has_none(tee_path):
    assert urdf_joints(tee_path) == {}
