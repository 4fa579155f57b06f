import json
import struct
import sys

import numpy as np
import pytest
from mcap.writer import CompressionType

from kinesic.capture.read import read_clip
from kinesic.capture.reading.ros_messages import read_joint_mcap, read_joint_trajectory
from kinesic.capture.reading.text import CaptureError

from ..ros_files import JOINT_STATE, JOINT_TRAJECTORY, joint_state, joint_trajectory, mcap, state_messages

# Two joint states as serialised by rosbags 0.11.9 (serialize_cdr, types of ROS 2 Humble)
ROSBAGS_STATES = [
    bytes.fromhex(
        f"000100000c000000{nanoseconds}050000006261736500000000020000000b0000006c6566745f656c626f770000050000006e65636b"
        f"0000000002000000{positions}0200000000000000000000000000f83f000000000000000000000000"
    )
    for nanoseconds, positions in (
        ("0065cd1d", "9a9999999999b93f9a9999999999c9bf"),
        ("0092fe1e", "333333333333d33f9a9999999999d9bf"),
    )
]
STATES = {"/joint_states": (JOINT_STATE, state_messages())}


@pytest.mark.parametrize("compression", CompressionType)
def test_joint_states_of_an_mcap_file_are_read_by_name_and_time_stamp(compression):
    clip = read_joint_mcap(mcap(STATES, compression=compression), "a.mcap")
    assert clip.names == ("pan", "tilt")
    assert clip.times == pytest.approx(np.arange(40) / 50)
    assert clip.angles == pytest.approx(np.outer(np.arange(40), [0.01, 0.02]))
    assert clip.guesses == ()


def test_joint_states_serialised_by_the_library_rosbags_are_read():
    messages = [(0.0, ROSBAGS_STATES[0]), (0.1, ROSBAGS_STATES[1])]
    clip = read_joint_mcap(mcap({"/joint_states": (JOINT_STATE, messages)}), "a.mcap")
    assert clip.names == ("left_elbow", "neck")
    assert clip.times == pytest.approx([0.0, 0.02])
    assert clip.angles.tolist() == [[0.1, -0.2], [0.3, -0.4]]


def test_log_times_of_ros_messages_replace_time_stamps_of_zero():
    messages = [(7.0 + k / 10, joint_state(0.0, ["a"], [float(k)])) for k in range(3)]
    clip = read_joint_mcap(mcap({"/a": (JOINT_STATE, messages)}), "a.mcap")
    assert clip.times == pytest.approx([0, 0.1, 0.2])


def test_big_endian_ros_messages_are_read():
    messages = [(k / 10, joint_state(1 + k / 10, ["one", "b"], [k, 2.5], order=">")) for k in range(2)]
    clip = read_joint_mcap(mcap({"/a": (JOINT_STATE, messages)}), "a.mcap")
    assert clip.names == ("one", "b")
    assert clip.angles == pytest.approx(np.array([[0, 2.5], [1, 2.5]]))


def test_first_ros_trajectory_of_a_file_is_read_and_further_ones_are_counted():
    trajectory = joint_trajectory(["pan", "tilt"], [0.5, 1.0, 2.25], [[0, 1], [2, 3], [4, 5]])
    other = joint_trajectory(["pan", "tilt"], [0.0, 9.0], [[0, 0], [0, 0]])
    topics = {
        "/arm/joint_trajectory": (JOINT_TRAJECTORY, [(0.0, trajectory), (1.0, other)]),
        "/joint_states": (JOINT_STATE, state_messages(5)),
        "/rosout": ("rcl_interfaces/msg/Log", [(0.0, b"no CDR")]),
    }
    clip = read_joint_mcap(mcap(topics), "a.mcap")
    assert clip.times == pytest.approx([0, 0.5, 1.75])
    assert clip.angles == pytest.approx(np.arange(6.0).reshape(3, 2))
    assert clip.guesses == ("topic /arm/joint_trajectory; 6 messages of other joints left out",)


def test_joint_states_of_a_second_ros_publisher_with_other_joints_are_skipped():
    messages = [*state_messages(5), *state_messages(3, names=("wheel",))]
    clip = read_joint_mcap(mcap({"/joint_states": (JOINT_STATE, messages)}), "a.mcap")
    assert len(clip.times) == 5
    assert clip.guesses == ("topic /joint_states; 3 messages of other joints left out",)


def test_ros_trajectory_in_a_json_file_is_read(tmp_path):
    points = [{"positions": [k, -k], "time_from_start": {"sec": k, "nanosec": 500_000_000}} for k in range(3)]
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"header": {}, "joint_names": ["pan", "tilt"], "points": points}))
    clip = read_clip(path)
    assert clip.names == ("pan", "tilt")
    assert clip.times == pytest.approx([0, 1, 2])
    assert clip.angles == pytest.approx(np.array([[0, 0], [1, -1], [2, -2]]))


def states(*messages, **options) -> bytes:
    return mcap({"/joint_states": (JOINT_STATE, [(k / 10, data) for k, data in enumerate(messages)])}, **options)


STATE = joint_state(1.0, ["a"], [0.0])
MANY_NAMES = b"\0\1\0\0" + struct.pack("<iII", 1, 0, 1) + b"\0\0\0\0" + struct.pack("<I", 2**31)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\x89MCAP1", "not an MCAP file"),
        (mcap(STATES)[:400], "a.mcap: byte [0-9]+: a record of .* bytes is incomplete"),
        (mcap({"/log": ("rcl_interfaces/msg/Log", [(0.0, b"")])}), "no topic of type sensor_msgs/msg/JointState or"),
        (states(STATE, encoding="ros1"), r"topic /joint_states: its encoding is 'ros1'; it must be cdr"),
        (states(b"\5\5\5\5"), "message at 0.000 s: its first bytes are not those of CDR"),
        (states(STATE[:-30]), "message at 0.000 s: it ends within a field of 8 bytes"),
        (states(MANY_NAMES), r"it has 2147483648 joints; at most 1000 are read"),
        (states(joint_state(1.0, ["a", "b"], [0.0])), "a position for each of its 2 names"),
        (states(joint_state(1.0, [], [])), "each of its 0 names"),
        (states(joint_state(1.0, ["a", "a"], [0.0, 1.0]), joint_state(2.0, ["a", "a"], [0.0, 1.0])), "the same joint"),
        (states(STATE), "it has 1 frames"),
        (states(STATE, STATE), "not in order of time"),
        (states(STATE, joint_state(2.0, ["a"], [np.nan])), "positions: a number is not finite"),
    ],
)
def test_invalid_mcap_file_is_rejected(data, message):
    with pytest.raises(CaptureError, match=message):
        read_joint_mcap(data, "a.mcap")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b'{"joint_names": []}', "not a joint trajectory: .* missing required field `points`"),
        (b'{"joint_names": [], "points": []}', "joint_names has 0 names"),
        (
            b'{"joint_names": ["a"], "points": [{"positions": [1, 2], "time_from_start": {}}]}',
            r"points\[0\]: 2 positions for 1 joints",
        ),
    ],
)
def test_invalid_ros_trajectory_in_json_is_rejected(data, message):
    with pytest.raises(CaptureError, match=message):
        read_joint_trajectory(data, "a.json")


@pytest.mark.parametrize("compression", [CompressionType.LZ4, CompressionType.ZSTD])
def test_mcap_chunk_that_unpacks_to_another_size_is_refused(compression):
    """Use a chunk whose stated size is one byte too small."""
    data = mcap(STATES, compression=compression)
    chunk = data.index(b"\x06", data.index(b"\x06") if data[8] == 6 else 8 + 9)
    position = next(k for k in range(chunk, len(data)) if data[k] == 6 and data[k + 9 : k + 17] == b"\0" * 8)
    size = struct.unpack_from("<Q", data, position + 25)[0]
    changed = data[: position + 25] + struct.pack("<Q", size - 1) + data[position + 33 :]
    with pytest.raises(CaptureError, match=rf"a chunk unpacks to {size} bytes, but states {size - 1}"):
        read_joint_mcap(changed, "a.mcap")


@pytest.mark.parametrize(
    ("compression", "package"), [(CompressionType.LZ4, "lz4"), (CompressionType.ZSTD, "zstandard")]
)
def test_missing_mcap_decompressor_is_reported_with_the_extra_that_installs_it(monkeypatch, compression, package):
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, f"{package}.frame", None)
    with pytest.raises(CaptureError, match=rf"chunks need {package}: .*kinesic\[bags\]"):
        read_joint_mcap(mcap(STATES, compression=compression), "a.mcap")
