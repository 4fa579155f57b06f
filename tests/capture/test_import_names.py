"""Names, licences, hands and body rotations of imported gestures, with clips of known motion."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.capture import gesture_library
from kinesic.capture.clip import BodyClip, JointClip
from kinesic.capture.gesture_library import import_folder, write_folder
from kinesic.capture.reading.text import CaptureError
from kinesic.expressivity.lexicon.captured_gesture import CARD_FILE
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion

from ..expressivity.lexicon.captured_clips import MARKERS, motion

CLIP = BodyClip(np.zeros(2), {}, np.zeros((2, 3)))


class KnownClips:
    """Clips of known motion in place of those read from files."""

    def __init__(self, monkeypatch):
        self.motion, self.clip = motion(), CLIP
        self.markers, self.is_found = {**MARKERS, "stroke": 1.00049, "end": 1.8996}, True
        monkeypatch.setattr(gesture_library, "read_clip", self._read)
        monkeypatch.setattr(gesture_library, "gesture_markers", lambda clip: (self.markers, self.is_found))
        monkeypatch.setattr(gesture_library, "gesture_motion", lambda clip, robot, source: self.motion)

    def _read(self, path):
        if path.stem.startswith("bad"):
            raise CaptureError(f"{path.name} is bad")
        return self.clip


@pytest.fixture
def known_clips(monkeypatch) -> KnownClips:
    return KnownClips(monkeypatch)


def import_names(folder: Path, *names: str, **options):
    """Import empty files with the given names."""
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    return import_folder(folder, None, **options)


@pytest.mark.parametrize(
    ("names", "ids"),
    [
        (["Actor@Wave.bvh"], ["wave"]),
        (["A@B@NodHead3.bvh"], ["nod_head_3"]),
        (["3_steps.bvh"], ["g_3_steps"]),
        (["@.bvh"], ["gesture"]),
        (["wave.bvh", "x/wave.bvh", "y/wave.bvh"], ["wave", "wave2", "wave3"]),
        (["wave9.bvh", "x/wave9.bvh"], ["wave_9", "wave_2"]),
        (["con.bvh"], ["con_"]),
        (["Hello-World!.bvh"], ["hello_world"]),
    ],
)
def test_imported_gesture_has_a_plain_unused_name(known_clips, tmp_path, names, ids):
    imported = import_names(tmp_path / "clips", *names)
    assert [clip.id for clip in imported.clips] == ids


@pytest.mark.parametrize(
    ("name", "says", "like", "category"),
    [
        ("Actor@Idle01_OfferRt01.bvh", "captured: offer rt 01", "offer", None),
        ("Actor@Idle01_IdleStand02_Offer.bvh", "captured: offer", "offer", None),
        ("idle_.bvh", "captured: idle", "", "adaptor"),
        ("zzqx.bvh", "captured: zzqx", "", "adaptor"),
        ("12.bvh", "captured: 12", "", "adaptor"),
    ],
)
def test_imported_gesture_is_described_and_categorised_by_its_name(known_clips, tmp_path, name, says, like, category):
    (clip,) = import_names(tmp_path / "clips", name).clips
    assert f'says = "{says}"\n' in clip.text
    assert f'like = "{like}"\n' in clip.text
    assert category is None or clip.category == category
    assert clip.text.startswith(f'category = "{clip.category}"\n\n[[gesture]]\n')
    assert (clip.category == "adaptor") == (like == "")


@pytest.mark.parametrize(("sides", "hand"), [("r", "right"), ("l", "left"), ("lr", "both")])
@pytest.mark.parametrize("is_found", [True, False])
def test_imported_gesture_states_its_hands_and_markers(known_clips, tmp_path, sides, hand, is_found):
    known_clips.motion, known_clips.is_found = motion(sides=sides), is_found
    (clip,) = import_names(tmp_path / "clips", "wave.bvh").clips
    lines = clip.text.splitlines()
    assert f'hand = "{hand}"' in lines
    assert f"found = {str(is_found).lower()}" in lines
    assert 'file = "wave.npz"' in lines
    assert "stroke = 1.0, strokeEnd = 1.4, relax = 1.6, end = 1.9 }" in clip.text


def with_body(head=(0, 0, 0), trunk=(0, 0, 0), first=(0, 0, 0)) -> GestureMotion:
    """Return a motion with head and trunk rotations [deg] at its stroke, and of the head at its start."""
    plain = motion()
    rotations = {name: np.zeros((len(plain.times), 3)) for name in ("head", "trunk")}
    rotations["head"][plain.at(0.2)] = first
    rotations["head"][plain.at(1.0)], rotations["trunk"][plain.at(1.0)] = head, trunk
    return GestureMotion(plain.times, plain.hands, **{name: np.radians(rows) for name, rows in rotations.items()})


@pytest.mark.parametrize(
    ("body", "lines"),
    [
        (with_body(), []),
        (with_body(head=(0.99, 0, 0)), []),
        (with_body(head=(0, -1.01, 0)), ["head = { turn = 0.0, tilt = -1.0, roll = 0.0 }"]),
        (with_body(head=(1, 2, 3)), ["head = { turn = 3.0, tilt = 2.0, roll = 1.0 }"]),
        (with_body(head=(1, 2, 3), first=(2, 4, 8)), ["head = { turn = -5.0, tilt = -2.0, roll = -1.0 }"]),
        (with_body(head=(0, 30.1, 0)), []),
        (with_body(trunk=(0, 0, -29.9)), ["trunk = { turn = -29.9, tilt = 0.0, roll = 0.0 }"]),
    ],
)
def test_moderate_rotation_of_head_or_trunk_belongs_to_an_imported_gesture(known_clips, tmp_path, body, lines):
    known_clips.motion = body
    (clip,) = import_names(tmp_path / "clips", "wave.bvh").clips
    _, _, found = clip.text.partition("\n\n[gesture.body]\n")
    assert found.splitlines() == ([*lines, "nod = 0.0"] if lines else [])


def test_licence_and_origin_of_an_imported_clip_are_those_of_its_folder(known_clips, tmp_path):
    clips = tmp_path / "clips"
    (clips / "lab").mkdir(parents=True)
    (clips / "licence.md").write_text("# MIT\n")
    (clips / "lab" / "COPYING").write_text("\n\n  CC0  \n")
    (clips / "lab" / "License").write_text("later in the order of names\n")
    (clips / "lab" / "license_old.txt").write_text("another name\n")
    imported = import_names(clips, "wave.bvh", "lab/nod.bvh")
    texts = {clip.id: clip.text for clip in imported.clips}
    assert 'source = "clips/wave.bvh"\nlicence = "# MIT"\n' in texts["wave"]
    assert 'source = "clips/lab/nod.bvh"\nlicence = "CC0"\n' in texts["nod"]
    assert (imported.card.name, imported.card.licence, imported.card.source) == ("clips", "# MIT; CC0", "clips")
    assert imported.card.description == "2 captured gestures"
    given = import_names(clips, licence="GPL", source="a lab")
    assert all('source = "a lab"\nlicence = "GPL"\n' in clip.text for clip in given.clips)
    assert (given.card.licence, given.card.source) == ("GPL", "a lab")


def test_licence_of_imported_clips_is_read_from_the_first_twenty_lines_of_the_file(known_clips, tmp_path):
    clips = tmp_path / "clips"
    clips.mkdir()
    (clips / "LICENSE").write_text("\n" * 19 + "MIT\n")
    assert import_names(clips, "wave.bvh").card.licence == "MIT"


def test_clips_are_imported_in_the_order_of_their_names_with_progress(known_clips, tmp_path):
    fractions = []
    imported = import_names(tmp_path / "c", "b.BVH", "a.npz", "bad.glb", "d/c.amc", progress=fractions.append)
    assert [clip.id for clip in imported.clips] == ["a", "b", "c"]
    assert imported.problems == ("bad.glb is bad",)
    assert fractions == [0.0, 0.25, 0.5, 0.75]
    assert imported.card.description == "3 captured gestures"


def test_robot_data_files_and_folders_are_not_imported_as_gesture_clips(known_clips, tmp_path):
    (tmp_path / "c" / "folder.bvh").mkdir(parents=True)
    imported = import_names(tmp_path / "c", "a.bvh", "b.csv", "c.json", "d.mcap", "e.parquet", "f.txt")
    assert [clip.id for clip in imported.clips] == ["a"]


def test_joint_angles_of_one_robot_are_not_imported_as_a_gesture(known_clips, tmp_path):
    known_clips.clip = JointClip(np.zeros(2), ("a",), np.zeros((2, 1)))
    with pytest.raises(ConfigError, match=r"first problem: .*a.npz: joint angles of one robot are no gesture"):
        import_names(tmp_path / "c", "a.npz", "b.npz")


def test_folder_of_up_to_2000_clips_is_imported(known_clips, tmp_path, monkeypatch):
    assert gesture_library.MAX_CLIPS == 2000
    monkeypatch.setattr(gesture_library, "MAX_CLIPS", 2)
    assert len(import_names(tmp_path / "c", "a.bvh", "b.bvh").clips) == 2
    with pytest.raises(ConfigError, match=r"it has 3 clips .*must have 1 to 2"):
        import_names(tmp_path / "c", "c.bvh")


def test_imported_gestures_and_their_card_are_written_beside_each_other(known_clips, tmp_path):
    imported = import_names(tmp_path / "c", "a.bvh", "b.bvh")
    write_folder(imported, tmp_path)
    written = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert set(written) == {"a.toml", "a.npz", "b.toml", "b.npz", CARD_FILE}
    for clip in imported.clips:
        assert (written[f"{clip.id}.toml"].decode(), written[f"{clip.id}.npz"]) == (clip.text, clip.motion)


def test_collection_imported_from_the_file_system_root_is_named_gestures(known_clips, monkeypatch):
    folder = SimpleNamespace(is_dir=lambda: True, rglob=lambda pattern: [Path("/a.bvh")], name="", parent=Path("/"))
    monkeypatch.setattr(Path, "is_file", lambda self: self.suffix == ".bvh")
    imported = import_folder(folder, None, licence="CC0", source="a disk")
    assert imported.card.name == "gestures"
