import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinesic.body.config import ConfigError
from kinesic.capture.reading.bvh import read_bvh, read_bvh_skeleton
from kinesic.capture.skeleton_motion import joint_frames

from .files import load

TEXT = """HIERARCHY
ROOT Hips
{{
  OFFSET 0.0 0.0 0.0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Arm
  {{
    OFFSET 10.0 0.0 0.0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {{
      OFFSET 20.0 0.0 0.0
    }}
  }}
}}
MOTION
Frames: 99
Frame Time: 0.05
{rows}
"""
FRAMES = ((1, 2, 3, 10, 20, 30, 40, 50, 60), (1, 2, 4, 10, 20, 30, 40, 50, 65), (1, 2, 5, 10, 20, 30, 40, 50, 70))


def write(path, frames=FRAMES, text=TEXT):
    path.write_text(text.format(rows="\n".join(" ".join(map(str, row)) for row in frames)))
    return path


def test_bvh_rotations_are_multiplied_in_the_order_of_their_channels(tmp_path):
    joints, motion = load(read_bvh, write(tmp_path / "a.bvh"))
    frames = joint_frames(joints, motion)
    hips = Rotation.from_euler("ZXY", [10, 20, 30], degrees=True)
    arm = Rotation.from_euler("YXZ", [40, 50, 60], degrees=True)
    assert frames.positions["Hips"][1] == pytest.approx([1, 2, 4])
    assert frames.positions["Arm"][0] - [1, 2, 3] == pytest.approx(hips.apply([10, 0, 0]))
    assert frames.rotations["Arm"][0] == pytest.approx((hips * arm).as_matrix())


def test_bvh_frame_count_is_the_number_of_rows_and_not_the_number_in_the_header(tmp_path):
    _, motion = load(read_bvh, write(tmp_path / "a.bvh"))
    assert motion.times == pytest.approx([0.0, 0.05, 0.1])


def test_first_bvh_frame_with_a_calibration_pose_is_dropped(tmp_path):
    _, motion = load(read_bvh, write(tmp_path / "a.bvh", ((0,) * 9, *FRAMES)))
    assert motion.times == pytest.approx([0.0, 0.05, 0.1])
    assert motion.frames[0, motion.columns["Hips", "XPos"]] == pytest.approx([1.0])


def test_bvh_skeleton_has_joints_but_no_end_sites(tmp_path):
    joints = load(read_bvh_skeleton, write(tmp_path / "a.bvh"))
    assert [(joint.name, joint.parent) for joint in joints] == [("Hips", None), ("Arm", "Hips")]
    assert joints[1].offset == pytest.approx([10, 0, 0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("MOTION", "MOTIONS", "MOTION"),
        ("0.05", "x", "could not convert"),
        ("OFFSET 10.0", "OFFSET ten", "could not convert"),
        ("HIERARCHY\nROOT Hips", "MOTION", "no joints"),
        ("Frame Time: 0.05", "Frame Time: -1", "positive"),
        ("Yrotation Xrotation Zrotation", "Yrotation Xrotation Yrotation", "channel 'Yrotation' occurs twice"),
    ],
)
def test_damaged_bvh_file_is_rejected_with_its_path(tmp_path, old, new, message):
    path = write(tmp_path / "a.bvh", text=TEXT.replace(old, new))
    with pytest.raises(ConfigError, match=message) as error:
        load(read_bvh, path)
    assert str(path) in str(error.value)


def test_non_finite_bvh_motion_is_rejected(tmp_path):
    with pytest.raises(ConfigError, match="finite"):
        load(read_bvh, write(tmp_path / "a.bvh", (FRAMES[0], (np.nan, *FRAMES[1][1:]))))
