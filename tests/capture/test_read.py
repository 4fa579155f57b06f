"""Tests of reading by suffix, and of captured clips in the corpus."""

import numpy as np
import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.capture.clip import BodyClip, JointClip
from kinesic.capture.read import FORMAT_NAMES, read_clip
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.skeleton_motion import joint_positions

from ..bench.naturalness.clips import write_clip, write_skeleton
from .clips import bvh, joint_csv, reach

CORPUS = find_corpus()
FOLDER = CORPUS / "capture" if CORPUS is not None else None
HAS_CLIPS = FOLDER is not None and FOLDER.is_dir()
CORPUS_CLIPS = sorted([*FOLDER.rglob("*.skm"), *FOLDER.rglob("*.bvh")]) if HAS_CLIPS else []
with_corpus = pytest.mark.skipif(not HAS_CLIPS, reason="no captured clips (KINESIC_CORPUS)")
BVH_FRAMES = 5  # number of frames of each BVH file whose matrices are multiplied


def test_file_suffix_selects_the_capture_format(tmp_path):
    (tmp_path / "a.BVH").write_bytes(bvh(reach(10)))
    (tmp_path / "a.csv").write_bytes(joint_csv())
    assert isinstance(read_clip(tmp_path / "a.BVH"), BodyClip)
    assert isinstance(read_clip(tmp_path / "a.csv"), JointClip)


def test_unknown_capture_suffix_error_lists_the_supported_suffixes(tmp_path):
    with pytest.raises(CaptureError, match=r"cannot read .fbx files; known: .bvh"):
        read_clip(tmp_path / "a.fbx")
    assert len(FORMAT_NAMES) >= 5
    with pytest.raises(CaptureError, match=r"/walk: its name has no suffix, which tells the format; known: .bvh"):
        read_clip(tmp_path / "walk")


def test_missing_capture_file_and_missing_skeleton_are_rejected(tmp_path):
    with pytest.raises(CaptureError, match="No such file"):
        read_clip(tmp_path / "a.bvh")
    path = write_clip(tmp_path / "ChrTest@a.skm", {"JtRoot XPos": np.zeros((3, 1))})
    with pytest.raises(CaptureError, match=r"no skeleton ChrTest.sk"):
        read_clip(path)


def test_smartbody_skeleton_is_found_in_a_folder_above(tmp_path):
    skeleton = write_skeleton(tmp_path / "skeletons")
    head = "joint JtNeckA { offset 0 0.2 0 joint JtSkullA { offset 0 0.1 0 channel Quat } }"
    skeleton.write_text(skeleton.read_text().replace("joint JtShoulderLf", f"{head}\n    joint JtShoulderLf", 1))
    clip = read_clip(write_clip(tmp_path / "set" / "ChrTest@a.skm", {"JtRoot XPos": np.zeros((5, 1))}))
    assert clip.arms["l"].wrist[0] == pytest.approx([0, 0, -1])
    assert clip.syncs["stroke"] == pytest.approx(1.4)


@with_corpus
@pytest.mark.parametrize("step", [12, pytest.param(1, marks=pytest.mark.soak)])
def test_captured_clips_of_the_corpus_are_read_with_plausible_arm_lengths(step):
    assert len([path for path in CORPUS_CLIPS if path.suffix == ".skm"]) == 136
    assert len([path for path in CORPUS_CLIPS if path.suffix == ".bvh"]) == 9
    for path in CORPUS_CLIPS[::step]:
        clip = read_clip(path)
        assert isinstance(clip, BodyClip)
        for arm in clip.arms.values():
            assert np.linalg.norm(arm.wrist, axis=1).max() < 1.01, path
            assert 0.4 < np.linalg.norm(arm.elbow, axis=1).min() < 0.65, path
            assert arm.wrist[0, 2] < 0.0, path  # nobody begins with raised arms


def multiply_matrices(text: str) -> dict[str, np.ndarray]:
    """Return joint positions of the first BVH rows by products of 4 x 4 matrices."""
    words = text.split()
    positions: dict[str, list[np.ndarray]] = {}
    start = words.index("Time:") + 2
    width = sum(int(words[k + 1]) for k, word in enumerate(words) if word == "CHANNELS")
    for frame in range(BVH_FRAMES):
        values = iter(map(float, words[start + frame * width : start + (frame + 1) * width]))
        stack, name, k = [np.eye(4)], "", 0
        while words[k] != "MOTION":
            word = words[k]
            if word in ("ROOT", "JOINT", "End"):
                name = words[k + 1] if word != "End" else ""
                k += 1
            elif word == "OFFSET":
                pending = np.eye(4)
                pending[:3, 3] = [float(number) for number in words[k + 1 : k + 4]]
                stack[-1] = stack[-1] @ pending
                k += 3
                if name and words[k + 1] != "CHANNELS":
                    positions.setdefault(name, []).append(stack[-1][:3, 3].copy())
            elif word == "CHANNELS":
                count = int(words[k + 1])
                kinds = words[k + 2 : k + 2 + count]
                k += 1 + count
                shift, rotation = np.zeros(3), np.eye(4)
                for kind, value in zip(kinds, [next(values) for _ in kinds], strict=True):
                    axis = "XYZ".index(kind[0])
                    if kind.endswith("position"):
                        shift[axis] = value if len(stack) == 2 else 0.0
                    else:
                        c, s, (i, j) = (
                            np.cos(np.radians(value)),
                            np.sin(np.radians(value)),
                            ((1, 2), (2, 0), (0, 1))[axis],
                        )
                        turn = np.eye(4)
                        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
                        rotation = rotation @ turn
                moved = np.eye(4)
                moved[:3, 3] = shift
                stack[-1] = stack[-1] @ moved
                positions.setdefault(name, []).append(stack[-1][:3, 3].copy())
                stack[-1] = stack[-1] @ rotation
            elif word == "{":
                stack.append(stack[-1].copy())
            elif word == "}":
                stack.pop()
            k += 1
    return {joint: np.array(rows) for joint, rows in positions.items()}


@with_corpus
def test_forward_kinematics_of_a_bvh_clip_equals_products_of_matrices():
    """Allow a difference of at most 1e-4 arm lengths."""
    for path in [path for path in CORPUS_CLIPS if path.suffix == ".bvh"]:
        data = path.read_bytes()
        skeleton, motion = read_bvh(data, path.name)
        expected = multiply_matrices(data.decode())
        shift = 1 if len(motion.times) < len(expected_rows(data)) else 0  # a T-pose was dropped
        positions = joint_positions(skeleton, motion)
        scale = np.ptp(np.stack([rows[0] for rows in expected.values()]), axis=0).max()
        for joint in skeleton:
            rows = positions[joint.name][: BVH_FRAMES - shift]
            assert np.abs(rows - expected[joint.name][shift:]).max() <= 1e-5 * scale, (path, joint.name)


def expected_rows(data: bytes) -> list[bytes]:
    """Return the lines of channel values in a BVH file."""
    rows = data.partition(b"Frame Time:")[2].split(b"\n")[1:]
    return [row for row in rows if row.strip()]
