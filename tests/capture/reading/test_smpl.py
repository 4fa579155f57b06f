import numpy as np
import pytest

from kinesic.capture.read import read_clip
from kinesic.capture.reading.joint_tables import read_npz
from kinesic.capture.reading.smpl import read_smpl
from kinesic.capture.reading.text import CaptureError

from ..clips import joint_npz

LEFT_SHOULDER, LEFT_ELBOW, HEAD = (slice(3 * k, 3 * k + 3) for k in (16, 18, 15))


def poses(count=10, columns=165) -> np.ndarray:
    """Return poses that lower the left arm and bend its elbow."""
    rotations = np.zeros((count, columns))
    rotations[:, LEFT_SHOULDER] = [0.0, 0.0, -np.pi / 2]  # about z, which is ahead
    rotations[:, LEFT_ELBOW] = [0.0, -np.pi / 2, 0.0]
    return rotations


def write(path, **arrays):
    path.write_bytes(joint_npz(**arrays))
    return path


def test_smpl_arm_rotations_move_elbow_and_wrist(tmp_path):
    clip = read_clip(write(tmp_path / "a.npz", poses=poses(), mocap_frame_rate=np.array(20.0)))
    arm = clip.arms["l"]
    assert clip.times[1] == pytest.approx(0.05)
    assert clip.guesses == ()
    assert arm.elbow[0][2] < -0.45
    forearm = arm.wrist[0] - arm.elbow[0]
    assert forearm[0] / np.linalg.norm(forearm) > 0.95  # ahead
    assert clip.arms["r"].wrist[0][1] < -0.9  # still to the side
    assert clip.head == pytest.approx(np.zeros((10, 3)), abs=1e-9)


def test_amass_pose_body_array_gives_the_same_arms_as_poses_of_all_joints(tmp_path):
    expected = read_clip(write(tmp_path / "a.npz", poses=poses(), mocap_framerate=np.array([120])))
    body = {"root_orient": np.ones((10, 3)), "pose_body": poses()[:, 3:66]}
    clip = read_clip(write(tmp_path / "b.npz", mocap_frame_rate=np.array(120.0), **body))
    assert clip.arms["l"].wrist == pytest.approx(expected.arms["l"].wrist)
    assert clip.times == pytest.approx(expected.times)


def test_missing_frame_rate_of_an_smpl_file_is_guessed_and_noted(tmp_path):
    clip = read_clip(write(tmp_path / "a.npz", poses=poses(columns=66)))
    assert clip.times[1] == pytest.approx(1 / 30)
    assert clip.guesses == ("frame rate taken as 30 Hz",)


def test_smpl_head_rotation_is_measured_relative_to_the_chest(tmp_path):
    rotations = poses()
    rotations[:, HEAD] = [0.3, 0.0, 0.0]  # about x, to the left: nods down
    clip = read_clip(write(tmp_path / "a.npz", poses=rotations))
    assert clip.head[0] == pytest.approx([0.0, 0.3, 0.0], abs=0.02)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"poses": np.zeros((5, 60))}, "60 columns"),
        ({"pose_body": np.zeros((5, 60))}, "60 columns"),
        ({"poses": np.full((5, 66), np.nan)}, "finite"),
        ({"poses": np.zeros((5, 66)), "mocap_frame_rate": np.array(-1.0)}, "positive"),
        ({"poses": np.zeros((5, 66)), "mocap_frame_rate": np.array(["x"])}, "one number"),
        ({"poses": np.zeros((1, 66))}, "1 frames"),
    ],
)
def test_invalid_smpl_motion_is_rejected(arrays, message):
    with pytest.raises(CaptureError, match=message):
        read_smpl(read_npz(joint_npz(**arrays), "a.npz"), "a.npz")
