import numpy as np
import pytest

from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.read import read_clip
from kinesic.capture.reading.acclaim import read_acclaim_motion, read_acclaim_skeleton
from kinesic.capture.reading.text import CaptureError

from ..acclaim_files import acclaim_motion, acclaim_skeleton

AHEAD, LEFT, UP = np.eye(3)


def left_wrist(*, skeleton=None, **motion) -> np.ndarray:
    """Return the left wrist [arm lengths] of the first frame in the chest frame."""
    joints = read_acclaim_skeleton(skeleton or acclaim_skeleton(), "a.asf")
    moved, _ = read_acclaim_motion(acclaim_motion(**motion), "a.amc", joints)
    return clip_of_skeleton(joints.joints, moved, "a.amc").arms["l"].wrist[0]


def test_acclaim_arm_without_rotation_points_in_the_direction_of_its_bones():
    assert left_wrist() == pytest.approx(LEFT)


def test_acclaim_shoulder_rotation_about_z_raises_the_arm():
    assert left_wrist(lhumerus="0 0 90") == pytest.approx(UP)


def test_acclaim_rotations_are_applied_in_the_order_of_the_degrees_of_freedom():
    """Rotate an arm along x first about x, which has no effect."""
    assert left_wrist(lhumerus="90 0 90") == pytest.approx(UP)


def test_acclaim_bone_rotates_about_its_own_axes():
    """Use a bone whose z axis points down: the arm swings forward."""
    skeleton = acclaim_skeleton(axis="90 0 0 XYZ")
    assert left_wrist(skeleton=skeleton, lhumerus="0 0 90") == pytest.approx(AHEAD)


def test_order_of_an_acclaim_bones_axis_angles_changes_the_direction_of_its_axes():
    """Compare the axis orders ZX and XZ."""
    first = left_wrist(skeleton=acclaim_skeleton(axis="90 0 90 XYZ"), lhumerus="0 0 90")
    second = left_wrist(skeleton=acclaim_skeleton(axis="90 0 90 ZYX"), lhumerus="0 0 90")
    assert np.abs(first - second).max() > 0.5


def test_acclaim_joint_with_one_degree_of_freedom_bends_the_elbow():
    """Expect the forearm (5/11 of the arm) to point forward."""
    assert left_wrist(lradius="-90") == pytest.approx((6 * LEFT + 5 * AHEAD) / 11)


def test_arm_paths_do_not_depend_on_position_and_heading_of_the_acclaim_root():
    assert left_wrist(root="7 -3 2 0 130 0", lhumerus="0 0 90") == pytest.approx(UP)


def test_acclaim_angles_in_radians_are_recognised_in_skeleton_and_motion_files():
    skeleton = acclaim_skeleton(axis=f"{np.pi / 2} 0 0 XYZ", unit="rad")
    wrist = left_wrist(skeleton=skeleton, lhumerus=f"0 0 {np.pi / 2}", heading=":FULLY-SPECIFIED\n:RADIANS")
    assert wrist == pytest.approx(AHEAD)


def test_acclaim_skeleton_is_found_by_its_subject_and_the_assumed_frame_rate_reported(tmp_path):
    (tmp_path / "02.asf").write_bytes(acclaim_skeleton())
    (tmp_path / "05.asf").write_bytes(b"")
    (tmp_path / "02_01.amc").write_bytes(acclaim_motion(13))
    clip = read_clip(tmp_path / "02_01.amc")
    assert clip.times[-1] == pytest.approx(0.1)
    assert "frame rate taken as 120 Hz" in clip.guesses


def test_single_acclaim_skeleton_of_a_folder_is_used_and_without_any_the_error_names_the_expected_file(tmp_path):
    (tmp_path / "walk.amc").write_bytes(acclaim_motion())
    with pytest.raises(CaptureError, match=r"walk.amc: no skeleton walk.asf beside it"):
        read_clip(tmp_path / "walk.amc")
    (tmp_path / "subject.asf").write_bytes(acclaim_skeleton())
    assert read_clip(tmp_path / "walk.amc").arms["l"].wrist[0] == pytest.approx(LEFT)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name rradius", "name lradius", r"a.asf:\d+: bone 'lradius' occurs twice"),
        ("rradius rwrist", "lradius rwrist\nrradius rwrist", r"a.asf:\d+: bone 'rwrist' has two parents"),
        ("    rradius rwrist\n", "", "bone 'rwrist' has no parent in :hierarchy"),
        ("root lowerback", "rwrist lowerback", "not connected to root"),
        ("lowerneck head", "lowerneck hat", r"a.asf:\d+: 'hat' is no bone of :bonedata"),
        ("dof ry", "dof rw", r"a.asf:\d+: degrees of freedom 'rw'"),
        ("axis 0 0 0 XYZ", "axis 0 0 0 XXZ", r"a.asf:\d+: order of axes 'XXZ'"),
        ("length 5", "length five", r"a.asf:\d+: could not convert"),
        ("order TX", "sequence TX", r"a.asf:\d+: 'sequence'; the root has order"),
        ("order TX TY TZ RX RY RZ", "order", "it has no order in :root"),
    ],
)
def test_invalid_acclaim_skeleton_is_rejected_with_its_line(old, new, message):
    data = acclaim_skeleton().replace(old.encode(), new.encode(), 1)
    with pytest.raises(CaptureError, match=message):
        read_acclaim_skeleton(data, "a.asf")


@pytest.mark.parametrize(
    ("motion", "message"),
    [
        (acclaim_motion(lradius="1 2"), r"a.amc:\d+: lradius: 2 numbers; it needs 1"),
        (acclaim_motion(tail="1"), r"a.amc:\d+: .* 'tail' is no bone that moves"),
        (acclaim_motion(3).rpartition(b"\n")[0], "bone 'rradius' is missing in a frame"),
        (acclaim_motion(1), "1 frames; it needs from 2"),
        (b"root 1 2 3 4 5 6", "a.amc:1: not an .amc motion"),
    ],
)
def test_invalid_acclaim_motion_is_rejected_with_its_line(motion, message):
    skeleton = read_acclaim_skeleton(acclaim_skeleton(), "a.asf")
    with pytest.raises(CaptureError, match=message):
        read_acclaim_motion(motion, "a.amc", skeleton)
