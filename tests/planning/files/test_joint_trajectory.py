"""Tests of motions as ROS joint trajectories."""

import json
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from kinesic.capture.reading.ros_messages import read_joint_mcap
from kinesic.planning.files.joint_trajectory import SampledJoints, write_trajectory_json, write_trajectory_mcap

TIMES = np.array([0.0, 0.01, 1.999999999])
ANGLES = np.array([[0.1, -0.2, 1.0], [0.3, 0.4, 2.0], [0.123456789012, 0.0, 3.0]])
JOINTS = SampledJoints(TIMES, ("left_elbow", "neck", "a"), ANGLES, ANGLES + 1.0, ANGLES + 2.0)

# Message of the test below as serialised by rosbags 0.11.9 (serialize_cdr, types of ROS 2 Humble)
ROSBAGS_BYTES = bytes.fromhex(
    "0001000000000000000000000100000000000000020000000b0000006c6566745f656c626f770000050000006e65636b0000000002000000"
    "020000009a9999999999b93f9a9999999999c9bf02000000000000009a9999999999f13f9a9999999999e93f0200000000000000cdcccccc"
    "cccc0040cdccccccccccfc3f00000000000000000000000002000000333333333333d33f9a9999999999d93f0200000000000000cdcccccc"
    "ccccf43f666666666666f63f020000000000000066666666666602403333333333330340000000000100000080b2e60e"
)


def test_trajectory_json_has_the_fields_of_the_ros_message(tmp_path: Path):
    write_trajectory_json(JOINTS, tmp_path / "a.json")
    message = json.loads((tmp_path / "a.json").read_text())
    assert list(message) == ["header", "joint_names", "points"]
    assert message["joint_names"] == ["left_elbow", "neck", "a"]
    assert message["points"][1] == {
        "positions": [0.3, 0.4, 2.0],
        "velocities": [1.3, 1.4, 3.0],
        "accelerations": [2.3, 2.4, 4.0],
        "effort": [],
        "time_from_start": {"sec": 0, "nanosec": 10_000_000},
    }
    assert message["points"][2]["time_from_start"] == {"sec": 1, "nanosec": 999_999_999}
    assert message["points"][2]["positions"][0] == 0.123456789


def test_trajectory_mcap_has_one_message_of_the_ros_type(tmp_path: Path):
    write_trajectory_mcap(JOINTS, tmp_path / "a.mcap")
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros2"
        ((schema, channel, message),) = reader.iter_messages()
    assert (schema.name, schema.encoding) == ("trajectory_msgs/msg/JointTrajectory", "ros2msg")
    assert (channel.topic, channel.message_encoding) == ("/joint_trajectory", "cdr")
    assert b"float64[] accelerations" in schema.data
    body = message.data[4:]
    assert message.data[:4] == b"\0\1\0\0"
    first = body.index(np.array(ANGLES[0]).tobytes())
    assert first % 8 == 0
    numbers = np.frombuffer(body[first : first + 24], "<f8")
    assert numbers.tolist() == ANGLES[0].tolist()
    assert np.frombuffer(body[first + 32 : first + 56], "<f8").tolist() == JOINTS.velocities[0].tolist()


def test_trajectory_mcap_is_read_back_with_equal_angles(tmp_path: Path):
    write_trajectory_mcap(JOINTS, tmp_path / "a.mcap")
    clip = read_joint_mcap((tmp_path / "a.mcap").read_bytes(), "a.mcap")
    assert clip.names == JOINTS.names
    np.testing.assert_array_equal(clip.angles, ANGLES)
    assert clip.times == pytest.approx(TIMES, abs=1e-9)


def test_serialised_trajectory_equals_the_bytes_of_the_library_rosbags(tmp_path: Path):
    times, angles = np.array([0.0, 1.25]), np.array([[0.1, -0.2], [0.3, 0.4]])
    joints = SampledJoints(times, ("left_elbow", "neck"), angles, angles + 1.0, angles + 2.0)
    write_trajectory_mcap(joints, tmp_path / "a.mcap")
    with (tmp_path / "a.mcap").open("rb") as file:
        ((_, _, message),) = make_reader(file).iter_messages()
    assert message.data == ROSBAGS_BYTES
