"""Verb `kinesic servos record` on virtual servos that are moved by hand."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.capture.reading.joint_tables import read_joint_csv

ELBOW_ANGLES = (0.0, 60.0, 40.0)  # [deg] successive angles of an elbow from its start


def test_joints_moved_by_hand_are_recorded_into_a_file_that_reads_as_a_clip(kinesic, table, tmp_path: Path):
    path = tmp_path / "hand.csv"
    table.turn(*(lambda hinge, angle=angle: angle * (hinge == "r_elbow_flexion") for angle in ELBOW_ANGLES))
    ended = kinesic("servos", "record", "--port", table.port, "--seconds", "1", "--out", path)
    assert (ended.code, ended.out.splitlines()[-1]) == (0, str(path))
    clip = read_joint_csv(path.read_bytes(), path.name)
    assert list(clip.names) == [hinge.name for hinge in Robot.load().skeleton.hinges]
    moved = np.degrees(clip.angles - clip.angles[0])
    elbow = clip.names.index("r_elbow_flexion")
    for angle in ELBOW_ANGLES:
        assert np.abs(moved[:, elbow] - angle).min() < 0.2
    assert np.abs(np.delete(moved, elbow, axis=1)).max() < 0.2
    assert np.diff(clip.times) == pytest.approx(0.02, abs=0.01)
    assert clip.times[-1] == pytest.approx(1.0, abs=0.05)
    assert table.energised == 0


def test_record_verb_refuses_servos_whose_torque_is_on(kinesic, table, tmp_path: Path):
    table.energise()
    ended = kinesic("servos", "record", "--port", table.port, "--seconds", "1", "--out", tmp_path / "hand.csv")
    assert ended.code == 2
    assert "switch it off with `kinesic servos release`" in ended.err
    assert not (tmp_path / "hand.csv").exists()


def test_record_verb_replaces_an_existing_recording_only_with_force(kinesic, table, tmp_path: Path):
    path = tmp_path / "hand.csv"
    path.write_text("mine")
    command = ("servos", "record", "--port", table.port, "--seconds", "0.1", "--out", path)
    assert kinesic(*command).code == 2
    assert path.read_text() == "mine"
    assert kinesic(*command, "--force").code == 0
    assert path.read_text().startswith("time_s,")


def test_record_verb_without_a_terminal_needs_a_duration(kinesic, table, tmp_path: Path):
    ended = kinesic("servos", "record", "--port", table.port, "--out", tmp_path / "hand.csv")
    assert ended.code == 2
    assert "give --seconds N" in ended.err
