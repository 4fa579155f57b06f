import numpy as np
import pytest

from kinesic.capture.reading.joint_tables import read_joint_csv, read_joint_npz, read_npz
from kinesic.capture.reading.text import CaptureError
from kinesic.planning.files.motion_files import save_motion
from kinesic.session.plan import plan

from ...performances import CALM_BML
from ..clips import joint_csv, joint_npz
from .files import load


def test_csv_file_with_angles_in_radians_gives_joints_by_name():
    clip = read_joint_csv(joint_csv(("elbow", "wrist")), "a.csv")
    assert clip.names == ("elbow", "wrist")
    assert clip.times[:3] == pytest.approx([0, 0.02, 0.04])
    assert clip.angles[10, 1] == pytest.approx(0.3 * np.sin(0.4))
    assert clip.guesses == ()


def from_npz(data, source):
    return read_joint_npz(read_npz(data, source), source)


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_csv_angles_in_degrees_are_converted_to_radians(delimiter):
    clip = read_joint_csv(joint_csv(unit="_deg", amplitude=30, delimiter=delimiter), "a.csv")
    assert clip.angles[10, 0] == pytest.approx(np.radians(30 * np.sin(0.2)))


@pytest.mark.parametrize(("amplitude", "unit"), [(30.0, "degrees"), (0.3, "radians")])
def test_angle_unit_of_a_csv_file_is_guessed_from_the_largest_angle(amplitude, unit):
    clip = read_joint_csv(joint_csv(unit="", amplitude=amplitude, frames=100), "a.csv")
    factor = np.pi / 180 if unit == "degrees" else 1.0
    assert clip.angles[10, 0] == pytest.approx(factor * amplitude * np.sin(0.2))
    assert unit in clip.guesses[0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"time_s", b"frame", "a.csv:1: it needs a header"),
        (b"\n0.02,", b"\nx,", "a.csv:3: could not convert"),
        (b"\n0.02,", b"\nnan,", "a.csv:3: a number is not finite"),
        (b"\n0.02,", b"\n0.02,0,", "a.csv:3: it has 4 columns, the header 3"),
        (b"\n0.04,", b"\n0.01,", "frame 3"),
        (b"b_rad", b"a_rad", "two columns"),
    ],
)
def test_invalid_csv_motion_file_is_rejected_with_its_line(old, new, message):
    with pytest.raises(CaptureError, match=message):
        read_joint_csv(joint_csv().replace(old, new), "a.csv")


def test_npz_file_with_a_frame_rate_gives_frame_times():
    angles = np.linspace(0, 1, 10)[:, None] * [1.0, 2.0]
    clip = from_npz(joint_npz(joint_names=np.array(["a_rad", "b_rad"]), q=angles, fps=np.array(25)), "a.npz")
    assert clip.times[-1] == pytest.approx(9 / 25)
    assert clip.angles == pytest.approx(angles)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"angles": np.zeros((10, 3))}, "shape"),
        ({"angles": np.full((10, 2), np.nan)}, "finite"),
        ({"times": np.zeros(10)}, "order of time"),
        ({"names": np.array([1, 2])}, "must be text"),
    ],
)
def test_invalid_npz_motion_file_is_rejected(changes, message):
    arrays = {"times": np.arange(10) / 10, "names": np.array(["a", "b"]), "angles": np.zeros((10, 2))}
    with pytest.raises(CaptureError, match=message):
        from_npz(joint_npz(**(arrays | changes)), "a.npz")


def test_exported_joint_motion_is_read_back_with_equal_angles(known, tmp_path):
    trajectory = plan(CALM_BML, known).trajectory
    for suffix, read in ((".npz", from_npz), (".csv", read_joint_csv)):
        clip = load(read, save_motion(trajectory, known.robot, tmp_path / f"a{suffix}", force=False))
        assert clip.names == known.robot.skeleton.names
        assert clip.guesses == ()
        assert clip.angles == pytest.approx(trajectory.angles(clip.times), abs=1e-8)
