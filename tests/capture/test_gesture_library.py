"""Import of folders of clips as gestures."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.capture.gesture_library import import_folder, write_folder
from kinesic.expressivity.lexicon.gesture_card import read_card
from kinesic.expressivity.lexicon.lexicon import Lexicon

from .clips import bvh, joint_csv, reach

HUMAN = Robot.load("human")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write a folder of clips with a licence file."""
    clips = tmp_path / "clips"
    (clips / "more").mkdir(parents=True)
    (clips / "LICENSE.txt").write_text("\nFree for all\nand more\n")
    (clips / "Actor@Idle01_OfferRt01.bvh").write_bytes(bvh(reach(120)))
    (clips / "more" / "Actor@Idle01_OfferRt01.bvh").write_bytes(bvh(reach(120, height=50)))
    (clips / "more" / "deep").mkdir()
    (clips / "more" / "deep" / "Actor@Idle01_OfferRt01.bvh").write_bytes(bvh(reach(120)))
    (clips / "zzqx.bvh").write_bytes(bvh(reach(120)))
    (clips / "broken.bvh").write_bytes(b"HIERARCHY nothing")
    (clips / "joints.csv").write_bytes(joint_csv())
    return clips


def test_imported_clips_become_gestures_named_after_their_files(folder, tmp_path):
    imported = import_folder(folder, HUMAN, source="a lab")
    write_folder(imported, tmp_path)
    lexicon = Lexicon.load(tmp_path)
    ids = [gesture.id for gesture in lexicon.captured]
    assert ids == ["idle_01_offer_rt_01", "idle_01_offer_rt_2", "idle_01_offer_rt_3", "zzqx"]
    offer, _, _, unknown = lexicon.captured
    assert (offer.table.like, offer.table.hand, offer.table.found) == ("offer", "right", True)
    assert lexicon.forms_by_id["idle_01_offer_rt_01"].category == lexicon.forms_by_id["offer"].category
    assert (unknown.table.like, lexicon.forms_by_id["zzqx"].category) == ("", "adaptor")
    assert (offer.table.licence, offer.table.source) == ("Free for all", "a lab")
    (problem,) = imported.problems
    assert "broken.bvh" in problem
    card = read_card(tmp_path)
    assert (card.name, card.licence, card.source) == ("clips", "Free for all", "a lab")


@pytest.mark.parametrize(("name", "shown"), [("\N{GRINNING FACE}", "\N{GRINNING FACE}"), ("b\udcff", r"b\udcff")])
def test_clips_in_a_folder_with_an_unusual_name_are_written_with_a_readable_source(tmp_path, name, shown):
    try:
        (tmp_path / name).mkdir()
    except OSError as error:
        pytest.skip(f"this file system refuses the name: {error}")
    (tmp_path / name / f"{name}.bvh").write_bytes(bvh(reach(120)))
    write_folder(import_folder(tmp_path / name, HUMAN), tmp_path)
    (gesture,) = Lexicon.load(tmp_path).captured
    assert gesture.table.source == f"{shown}/{shown}.bvh"
    assert read_card(tmp_path).name == shown


def test_wrist_path_of_an_imported_clip_is_in_the_gesture_space_of_the_actor(folder):
    write_folder(import_folder(folder, HUMAN), folder)
    motion = next(gesture for gesture in Lexicon.load(folder).captured if gesture.id == "zzqx").motion
    hanging = motion.hands["l"].wrist  # 80 degrees below the side; bones of 17, 29 and 26 cm from the midline
    expected = [0.0, 17 / 55 + np.cos(np.radians(80)), 29 / 55 - np.sin(np.radians(80))]
    np.testing.assert_allclose(hanging, np.tile(expected, (len(hanging), 1)), atol=0.01)


def test_licence_of_imported_clips_is_unknown_without_a_licence_file(tmp_path):
    clips = tmp_path / "a" / "b"
    clips.mkdir(parents=True)
    (clips / "wave.bvh").write_bytes(bvh(reach(60)))
    assert import_folder(clips, HUMAN).card.licence == "unknown"
    assert import_folder(clips, HUMAN, licence="MIT").card.licence == "MIT"


def test_licence_file_without_text_is_passed_over_for_the_one_above(tmp_path):
    clips = tmp_path / "a" / "b"
    clips.mkdir(parents=True)
    (clips / "wave.bvh").write_bytes(bvh(reach(60)))
    (clips / "LICENSE").write_text("\n \n")
    (tmp_path / "LICENSE").write_text("licence of something else\n")  # two folders above
    assert import_folder(clips, HUMAN).card.licence == "unknown"
    (tmp_path / "a" / "LICENSE").write_text("CC0\n")
    assert import_folder(clips, HUMAN).card.licence == "CC0"


def test_import_of_a_folder_without_readable_clips_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="no such folder"):
        import_folder(tmp_path / "nothing", HUMAN)
    with pytest.raises(ConfigError, match="has 0 clips"):
        import_folder(tmp_path, HUMAN)
    (tmp_path / "broken.bvh").write_bytes(b"nothing")
    with pytest.raises(ConfigError, match="no clip can be read"):
        import_folder(tmp_path, HUMAN)
