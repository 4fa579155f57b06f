import csv
import re

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.planning.files.bap import PARAMETER_COUNT, PARAMETER_NUMBERS
from kinesic.planning.files.motion_files import replace_motion_file, save_motion, write_motion

DEFAULT_ROBOT = Robot.load()


@pytest.fixture
def motion(through):
    angles = np.stack([DEFAULT_ROBOT.skeleton.rest, DEFAULT_ROBOT.skeleton.rest + 0.1])
    return through(np.array([0.0, 1.0]), angles)


def test_motion_npz_file_contains_joint_names_times_and_angles(motion, tmp_path):
    write_motion(motion, DEFAULT_ROBOT, tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as data:
        assert tuple(data["names"]) == DEFAULT_ROBOT.skeleton.names
        np.testing.assert_allclose(data["angles"], motion.sample(data["times"])[0])
        assert data["times"][-1] == pytest.approx(1.0)


def test_motion_csv_file_has_a_time_column_and_one_column_per_hinge(motion, tmp_path):
    write_motion(motion, DEFAULT_ROBOT, tmp_path / "m.csv")
    with (tmp_path / "m.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0][0] == "time_s"
    assert len(rows) == 102
    np.testing.assert_allclose([float(cell) for cell in rows[-1][1:]], DEFAULT_ROBOT.skeleton.rest + 0.1, atol=1e-8)


def test_bap_file_contains_angles_in_units_of_10_microradians(motion, tmp_path):
    write_motion(motion, DEFAULT_ROBOT, tmp_path / "m.bap")
    header, mask, first, *_ = (tmp_path / "m.bap").read_text().splitlines()
    assert header.split()[2:] == ["25", "26"]
    flags = mask.split()
    assert len(flags) == PARAMETER_COUNT
    assert flags.count("1") == 22
    values = dict(zip([k for k, flag in enumerate(flags, start=1) if flag == "1"], first.split()[1:], strict=True))
    elbow = DEFAULT_ROBOT.skeleton.rest[DEFAULT_ROBOT.skeleton.joint("l_elbow_flexion")]
    assert int(values[PARAMETER_NUMBERS["l_elbow_flexion"]]) == round(elbow * 1e5)


def test_bap_parameter_numbers_follow_the_standard():
    assert PARAMETER_NUMBERS["l_shoulder_flexion"] == 32
    assert PARAMETER_NUMBERS["r_wrist_twisting"] == 47
    assert PARAMETER_NUMBERS["skullbase_roll"] == 48
    assert PARAMETER_NUMBERS["vt1_roll"] == 72
    assert PARAMETER_NUMBERS["vl5_tilt"] == 122


def test_unknown_motion_file_suffix_error_names_the_supported_suffixes(motion, tmp_path):
    with pytest.raises(ConfigError, match=r"m\.txt.*\.npz, \.csv, \.bap"):
        write_motion(motion, DEFAULT_ROBOT, tmp_path / "m.txt")
    with pytest.raises(ConfigError, match=rf"^{re.escape(str(tmp_path / 'm.txt'))}: cannot write"):
        save_motion(motion, DEFAULT_ROBOT, tmp_path / "m.txt", force=False)


def test_bvh_and_joint_trajectories_are_replaced_only_by_force(motion, tmp_path):
    for ending in ("bvh", "json", "mcap"):
        path = save_motion(motion, DEFAULT_ROBOT, tmp_path / f"m.{ending}", force=False)
        content = path.read_bytes()
        with pytest.raises(ConfigError, match="is no motion written by kinesic; use force=True"):
            replace_motion_file(motion, DEFAULT_ROBOT, path, force=False)
        assert replace_motion_file(motion, DEFAULT_ROBOT, path, force=True).read_bytes() == content


@pytest.mark.parametrize("ending", ["csv", "npz", "bap"])
def test_only_files_written_by_kinesic_are_replaced_without_force(ending: str, motion, tmp_path):
    path = tmp_path / f"m.{ending}"
    for somebodys in (b"dear", b"", b"PK\3\4", b"3.2 other 25 1\n", b"time,x\n", b"\xff"):
        path.write_bytes(somebodys)
        with pytest.raises(ConfigError, match=r"is no motion written by kinesic; use force=True"):
            replace_motion_file(motion, DEFAULT_ROBOT, path, force=False)
        assert path.read_bytes() == somebodys
    for force in (True, False):
        assert replace_motion_file(motion, DEFAULT_ROBOT, path, force=force) == path
    other = save_motion(motion, DEFAULT_ROBOT, tmp_path / f"n.{ending}", force=False)
    assert replace_motion_file(motion, DEFAULT_ROBOT, other, force=False) == other


def test_npz_archives_of_other_programs_are_not_replaced(motion, tmp_path):
    np.savez(tmp_path / "m.npz", times=[1.0])
    with pytest.raises(ConfigError, match="no motion"):
        replace_motion_file(motion, DEFAULT_ROBOT, tmp_path / "m.npz", force=False)


def test_bap_header_contains_file_name(motion, tmp_path):
    assert (
        save_motion(motion, DEFAULT_ROBOT, tmp_path / "wave.bap", force=False)
        .read_text()
        .startswith("3.2 wave 25 26\n")
    )
