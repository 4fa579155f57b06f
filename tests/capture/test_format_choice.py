"""Readers of motion files by suffix and content, and the files that they need beside."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.capture import read
from kinesic.capture.clip import BodyClip
from kinesic.capture.read import find_acclaim_skeleton, find_skeleton, read_clip
from kinesic.capture.reading.text import CaptureError

CLIP = BodyClip(np.zeros(2), {}, np.zeros((2, 3)), guesses=("first",))


class RecordedReaders:
    """Readers that record their calls in place of those of a module."""

    def __init__(self, monkeypatch, **results):
        self.calls = []
        for name, result in results.items():
            monkeypatch.setattr(read, name, self._reader(name, result))

    def _reader(self, name, result):
        def call(*arguments):
            self.calls.append((name, arguments))
            return result

        return call


@pytest.mark.parametrize(
    ("name", "data", "reader"),
    [
        ("a.csv", b"x", "read_joint_csv"),
        ("a.MCAP", b"x", "read_joint_mcap"),
        ("a.json", b'{"joint_names": []}', "read_joint_trajectory"),
        ("a.json", b"{}", "read_reachy_move"),
    ],
)
def test_reader_of_a_motion_file_gets_its_bytes_and_path(tmp_path, monkeypatch, name, data, reader):
    names = ("read_joint_csv", "read_joint_mcap", "read_joint_trajectory", "read_reachy_move")
    recorded = RecordedReaders(monkeypatch, **dict.fromkeys(names, CLIP))
    (tmp_path / name).write_bytes(data)
    assert read_clip(tmp_path / name) is CLIP
    assert recorded.calls == [(reader, (data, str(tmp_path / name)))]


def test_table_in_a_parquet_file_is_read_by_its_path(tmp_path, monkeypatch):
    recorded = RecordedReaders(monkeypatch, read_lerobot=CLIP)
    assert read_clip(tmp_path / "a.parquet") is CLIP
    assert recorded.calls == [("read_lerobot", (tmp_path / "a.parquet",))]


@pytest.mark.parametrize("guess", ["second", ""])
def test_npz_file_with_smpl_poses_is_read_as_a_body_motion_with_its_guess(tmp_path, monkeypatch, guess):
    (tmp_path / "a.npz").write_bytes(b"x")
    readers = {
        "read_npz": {},
        "read_joint_npz": None,
        "read_smpl": ("bones", "motion", guess),
        "clip_of_skeleton": CLIP,
    }
    recorded = RecordedReaders(monkeypatch, is_smpl=True, **readers)
    assert read_clip(tmp_path / "a.npz").guesses == (("first", "second") if guess else ("first",))
    source = str(tmp_path / "a.npz")
    assert recorded.calls[2:] == [("read_smpl", ({}, source)), ("clip_of_skeleton", ("bones", "motion", source))]


def test_npz_file_without_smpl_poses_is_read_as_joint_angles(tmp_path, monkeypatch):
    (tmp_path / "a.npz").write_bytes(b"x")
    recorded = RecordedReaders(monkeypatch, is_smpl=False, read_npz={"b": 1}, read_joint_npz=CLIP, read_smpl=None)
    assert read_clip(tmp_path / "a.npz") is CLIP
    assert recorded.calls[-1] == ("read_joint_npz", ({"b": 1}, str(tmp_path / "a.npz")))


def test_acclaim_motion_is_read_with_the_skeleton_of_its_subject(tmp_path, monkeypatch):
    (tmp_path / "07_01.amc").write_bytes(b"motion")
    (tmp_path / "07.asf").write_bytes(b"bones")
    skeleton = SimpleNamespace(joints="joints")
    results = {"read_acclaim_skeleton": skeleton, "read_acclaim_motion": ("moved", "unit"), "clip_of_skeleton": CLIP}
    recorded = RecordedReaders(monkeypatch, **results)
    assert read_clip(tmp_path / "07_01.amc").guesses == ("first", "unit")
    motion, bones = str(tmp_path / "07_01.amc"), str(tmp_path / "07.asf")
    assert recorded.calls == [
        ("read_acclaim_skeleton", (b"bones", bones)),
        ("read_acclaim_motion", (b"motion", motion, skeleton)),
        ("clip_of_skeleton", ("joints", "moved", motion)),
    ]


def test_smartbody_motion_is_read_with_its_skeleton(tmp_path, monkeypatch):
    (tmp_path / "Actor@a.skm").write_bytes(b"motion")
    (tmp_path / "Actor.sk").write_bytes(b"bones")
    recorded = RecordedReaders(monkeypatch, read_skeleton="joints", read_motion="moved", clip_of_skeleton=CLIP)
    assert read_clip(tmp_path / "Actor@a.skm") is CLIP
    assert recorded.calls == [
        ("read_skeleton", (b"bones", str(tmp_path / "Actor.sk"))),
        ("read_motion", (b"motion", str(tmp_path / "Actor@a.skm"))),
        ("clip_of_skeleton", ("joints", "moved", str(tmp_path / "Actor@a.skm"))),
    ]


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_gltf_buffers_are_read_only_from_the_folder_of_the_file(tmp_path, monkeypatch, suffix):
    folder = tmp_path / "clips"
    folder.mkdir()
    path = folder / f"a{suffix}"
    path.write_bytes(b"x")
    (folder / "my data.bin").write_bytes(b"1234")
    (tmp_path / "out.bin").write_bytes(b"secret")
    recorded = RecordedReaders(monkeypatch, read_gltf=("joints", "moved", ("up axis",)), clip_of_skeleton=CLIP)
    assert read_clip(path).guesses == ("first", "up axis")
    _, (data, source, load) = recorded.calls[0]
    assert (data, source, load("my%20data.bin")) == (b"x", str(path), b"1234")
    for uri, problem in (("../out.bin", "outside"), ("b%00", "null"), ("no" * 30, "No such file"), (".", "")):
        with pytest.raises(CaptureError, match=f"a{suffix}: buffer .*{problem}"):
            load(uri)
    with pytest.raises(CaptureError, match=f"buffer '{'no' * 20}': No such"):
        load("no" * 30)
    monkeypatch.setattr(read, "MAX_FILE_SIZE", 3)
    with pytest.raises(CaptureError, match="has 4 bytes; at most 3"):
        load("my%20data.bin")


def touch(*paths: Path) -> None:
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


@pytest.mark.parametrize(
    ("present", "found"),
    [
        (("07_01.asf", "07.asf", "x.asf"), "07_01.asf"),
        (("07.asf", "x.asf"), "07.asf"),
        (("x.asf",), "x.asf"),
        (("x.asf", "y.asf"), None),
        ((), None),
    ],
)
def test_acclaim_skeleton_is_that_of_the_subject_or_the_only_one(tmp_path, present, found):
    touch(*(tmp_path / name for name in present))
    motion = tmp_path / "07_01_walk.amc" if found == "x.asf" else tmp_path / "07_01.amc"
    if found is None:
        with pytest.raises(CaptureError, match=r"07_01.amc: no skeleton 07.asf beside it"):
            find_acclaim_skeleton(motion)
    else:
        assert find_acclaim_skeleton(motion) == tmp_path / found


def test_folder_with_the_name_of_an_acclaim_skeleton_is_passed_over(tmp_path):
    (tmp_path / "07.asf").mkdir()
    with pytest.raises(CaptureError, match="no skeleton"):
        find_acclaim_skeleton(tmp_path / "07_01.amc")


@pytest.mark.parametrize(
    ("present", "found"),
    [
        (("c/d/e/A.sk", "c/d/e/skeletons/A.sk"), "c/d/e/A.sk"),
        (("c/d/e/skeletons/A.sk", "c/d/skeletons/A.sk"), "c/d/e/skeletons/A.sk"),
        (("c/d/skeletons/A.sk", "c/skeletons/A.sk"), "c/d/skeletons/A.sk"),
        (("c/skeletons/A.sk", "skeletons/A.sk"), "c/skeletons/A.sk"),
        (("skeletons/A.sk",), None),
        (("c/d/A.sk", "c/d/e/skeletons/B.sk"), None),
    ],
)
def test_smartbody_skeleton_lies_beside_the_motion_or_up_to_two_folders_above(tmp_path, present, found):
    touch(*(tmp_path / name for name in present))
    motion = tmp_path / "c" / "d" / "e" / "A@walk@2.skm"
    if found is None:
        with pytest.raises(CaptureError, match=r"no skeleton A.sk beside it or in skeletons/"):
            find_skeleton(motion)
    else:
        assert find_skeleton(motion) == tmp_path / found
