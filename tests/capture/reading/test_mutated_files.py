"""Damaged motion files of every format: each is read or refused with a located error."""

import numpy as np
import pytest

from kinesic.body.rotation import rotation_about
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.joint_tables import read_joint_csv, read_joint_npz, read_npz
from kinesic.capture.reading.reachy_move import read_reachy_move
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.smpl import is_smpl, read_smpl
from kinesic.capture.reading.text import CaptureError

from ...bench.naturalness.clips import SKELETON, write_clip
from ..clips import bvh, joint_csv, joint_npz, reach, reachy_move

MUTATIONS = 2000  # files of each format in `make soak`; every tenth of them otherwise
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


def refusal(read, data: bytes) -> str:
    """Return the message with which a file is refused, empty if it is read."""
    try:
        read(data, "a.file")
    except CaptureError as error:
        return str(error)
    return ""


def originals(tmp_path):
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
    }


@pytest.mark.parametrize("kind", ["bvh", "skm", "sk", "csv", "npz", "smpl", "reachy"])
@pytest.mark.parametrize("count", [MUTATIONS // 10, pytest.param(MUTATIONS, marks=pytest.mark.soak)])
def test_mutated_files_raise_only_capture_errors(tmp_path, kind, count):
    read, data = originals(tmp_path)[kind]
    read(data, "a")
    rng = np.random.default_rng(20261130)
    messages = [refusal(read, mutate(data, rng)) for _ in range(count)]
    assert any(messages)
    assert [message for message in messages if message and "a.file" not in message] == []
