"""Tests that damaged motion files are read or give a located error."""

import numpy as np
import pytest
from mcap.writer import CompressionType

from kinesic.body.rotation import rotation_about
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.reading.acclaim import read_acclaim_motion, read_acclaim_skeleton
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.gltf import read_gltf
from kinesic.capture.reading.joint_tables import read_joint_csv, read_joint_npz, read_npz
from kinesic.capture.reading.lerobot import read_lerobot
from kinesic.capture.reading.reachy_move import read_reachy_move
from kinesic.capture.reading.ros_messages import read_joint_mcap, read_joint_trajectory
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.smpl import is_smpl, read_smpl
from kinesic.capture.reading.text import CaptureError

from ...bench.naturalness.clips import SKELETON, write_clip
from ..acclaim_files import acclaim_motion, acclaim_skeleton
from ..clips import bvh, joint_csv, joint_npz, reach, reachy_move
from ..gltf_files import moving_person
from ..lerobot_files import write_dataset
from ..ros_files import JOINT_STATE, JOINT_TRAJECTORY, joint_trajectory, mcap, state_messages

MUTATIONS = 2000  # number of files of each format in `make soak`; ordinary test runs read one twentieth
WORDS = (b"nan", b"-1", b"1e999", b"{", b"}", b"\n", b" ", b"0", b"CHANNELS", b"\xff", b"[", b"null", b"9" * 30)


def mutate(data: bytes, rng: np.random.Generator) -> bytes:
    """Replace, delete or repeat some parts of a file."""
    for _ in range(int(rng.integers(1, 4))):
        begin = int(rng.integers(0, max(1, len(data))))
        end = begin + int(rng.choice([0, 1, 4, 40, 400]))
        match int(rng.integers(0, 5)):
            case 0:
                data = data[:begin] + WORDS[int(rng.integers(0, len(WORDS)))] + data[end:]
            case 1:
                data = data[:begin] + data[end:]
            case 2:
                data = data[:end] + data[begin:end] + data[end:]
            case 3:
                data = data[:begin]
            case _:
                data = data[:begin] + rng.bytes(end - begin) + data[end:]
    return data


def read_bvh_clip(data: bytes, source: str) -> object:
    return clip_of_skeleton(*read_bvh(data, source), source)


def read_arrays(data: bytes, source: str) -> object:
    arrays = read_npz(data, source)
    return read_smpl(arrays, source) if is_smpl(arrays) else read_joint_npz(arrays, source)


def read_gltf_clip(data: bytes, source: str) -> object:
    joints, motion, _ = read_gltf(data, source, lambda uri: b"")
    return clip_of_skeleton(joints, motion, source)


def read_acclaim_clip(data: bytes, source: str) -> object:
    """Read a skeleton and a motion, separated by the first line of the motion."""
    bones, mark, motion = data.partition(b"#!OML")
    skeleton = read_acclaim_skeleton(bones, source)
    moved, _ = read_acclaim_motion(mark + motion, source, skeleton)
    return clip_of_skeleton(skeleton.joints, moved, source)


def refusal(read, data: bytes) -> str:
    """Return the error message of a refused file, or an empty text."""
    try:
        read(data, "a.file")
    except CaptureError as error:
        return str(error)
    return ""


def originals(tmp_path):
    dataset = write_dataset(tmp_path / "set")

    def read_parquet(data: bytes, source: str) -> object:
        path = dataset.with_name(source)
        path.write_bytes(data)
        return read_lerobot(path)

    trajectory = joint_trajectory(["pan", "tilt"], [0.5, 1.0], [[0, 1], [2, 3]])
    points = b'{"positions": [1, 2], "time_from_start": {"sec": 1, "nanosec": 7}}'
    motion = write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.zeros((5, 1))}).read_bytes()
    poses = [rotation_about(np.array([0.0, 1.0, 0.0]), 0.1 * k) for k in range(5)]
    arrays = {"times": np.arange(5) / 10, "names": np.array(["a", "b"]), "angles": np.zeros((5, 2))}
    return {
        "bvh": (read_bvh_clip, bvh(reach(6), frames=6)),
        "skm": (read_motion, motion),
        "sk": (read_skeleton, SKELETON.encode()),
        "csv": (read_joint_csv, joint_csv()),
        "npz": (read_arrays, joint_npz(**arrays)),
        "smpl": (read_arrays, joint_npz(poses=np.zeros((5, 66)), mocap_frame_rate=np.array(30.0))),
        "reachy": (read_reachy_move, reachy_move(poses)),
        "acclaim": (read_acclaim_clip, acclaim_skeleton() + acclaim_motion()),
        "glb": (read_gltf_clip, moving_person(reach(6)).binary()),
        "gltf": (read_gltf_clip, moving_person(reach(6)).text()),
        "states": (read_joint_mcap, mcap({"/a": (JOINT_STATE, state_messages(30))})),
        "zstd": (read_joint_mcap, mcap({"/a": (JOINT_STATE, state_messages(30))}, compression=CompressionType.ZSTD)),
        "lz4": (read_joint_mcap, mcap({"/a": (JOINT_STATE, state_messages(30))}, compression=CompressionType.LZ4)),
        "trajectory": (read_joint_mcap, mcap({"/a": (JOINT_TRAJECTORY, [(0.0, trajectory)])})),
        "json": (
            read_joint_trajectory,
            b'{"joint_names": ["a", "b"], "points": [%s, %s]}' % (points, points.replace(b"7", b"8")),
        ),
        "parquet": (read_parquet, dataset.read_bytes()),
    }


KINDS = ("bvh", "skm", "sk", "csv", "npz", "smpl", "reachy", "acclaim", "glb", "gltf", "states", "zstd", "lz4")


@pytest.mark.parametrize("kind", [*KINDS, "trajectory", "json", "parquet"])
@pytest.mark.parametrize("count", [MUTATIONS // 20, pytest.param(MUTATIONS, marks=pytest.mark.soak)])
def test_mutated_motion_capture_files_raise_only_capture_errors(tmp_path, kind, count):
    read, data = originals(tmp_path)[kind]
    read(data, "a")
    rng = np.random.default_rng(20261130)
    count = count // 10 if kind == "parquet" else count  # DuckDB opens each file anew
    messages = [refusal(read, mutate(data, rng)) for _ in range(count)]
    assert any(messages)
    assert [message for message in messages if message and "a.file" not in message] == []
