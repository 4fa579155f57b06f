import io
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.sim import log
from kinesic.sim.log import read_log, write_log
from kinesic.sim.twin import Twin

ROBOT = Robot.load()
HINGE_NAMES = np.array(ROBOT.skeleton.names)
LOG_TIMES = np.array([0.0, 0.01, 0.02])
LOG_ANGLES = np.arange(66.0).reshape(3, 22) / 100
COMPLETE_ARRAYS = {"times": LOG_TIMES, "names": HINGE_NAMES, "goals": LOG_ANGLES + 1, "angles": LOG_ANGLES}


def test_log_of_a_twin_is_written_and_read_back(tmp_path):
    twin, still = Twin(ROBOT), np.zeros(22)
    for time in LOG_TIMES:
        twin.write(Command(time, ROBOT.skeleton.rest, still, still, ROBOT.skeleton.rest + 0.01))
    seen = twin.measurements()
    write_log(seen, ROBOT, tmp_path / "measured.npz")
    log = read_log(tmp_path / "measured.npz", ROBOT)
    for name in ("times", "setpoints", "angles"):
        assert np.array_equal(getattr(log, name), getattr(seen, name))


def test_servo_log_with_hinges_in_any_order_is_read_in_skeleton_order(tmp_path):
    order = np.random.default_rng(0).permutation(22)
    shuffled = {"names": HINGE_NAMES[order], "goals": LOG_ANGLES[:, order] + 1, "angles": LOG_ANGLES[:, order]}
    np.savez(tmp_path / "log.npz", **{**COMPLETE_ARRAYS, **shuffled})
    log = read_log(tmp_path / "log.npz", ROBOT)
    assert np.array_equal(log.angles, LOG_ANGLES)
    assert np.array_equal(log.setpoints, LOG_ANGLES + 1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"goals": None}, "lacks goals; a log is npz with times"),
        ({"names": np.array(["x", *HINGE_NAMES[1:]])}, "lacks 1 hinges of upper22, first vl5_torsion"),
        ({"angles": LOG_ANGLES[:2]}, r"angles is \(2, 22\), must be \(3, 22\)"),
        ({"angles": LOG_ANGLES * np.nan}, "angles holds a number that is not finite"),
        ({"times": LOG_TIMES[::-1]}, "times must be at least two, and increase"),
        ({"times": LOG_TIMES[[0, 0, 1]]}, "times must be at least two, and increase"),
    ],
)
def test_invalid_servo_log_is_rejected_with_its_fault(tmp_path, change, message):
    data = {name: values for name, values in {**COMPLETE_ARRAYS, **change}.items() if values is not None}
    np.savez(tmp_path / "log.npz", **data)
    with pytest.raises(ConfigError, match=message):
        read_log(tmp_path / "log.npz", ROBOT)


def test_missing_servo_log_and_other_file_types_are_rejected(tmp_path):
    with pytest.raises(ConfigError, match=r"none\.npz: No such file"):
        read_log(tmp_path / "none.npz", ROBOT)
    text = tmp_path / "text.npz"
    text.write_text("times")
    with pytest.raises(ConfigError, match="no log; a log is npz"):
        read_log(text, ROBOT)


def test_log_too_large_when_unpacked_is_rejected_before_unpacking(tmp_path, monkeypatch):
    monkeypatch.setattr(log, "MAX_LOG_SIZE", 50_000_000)
    path = tmp_path / "bomb.npz"
    with ZipFile(path, "w", ZIP_DEFLATED) as whole, whole.open("angles.npy", "w") as part:
        for _ in range(60):
            part.write(bytes(1_000_000))
    assert path.stat().st_size < 100_000
    with pytest.raises(ConfigError, match=r"bomb\.npz: unpacks to 60 MB, at most 50 are read"):
        read_log(path, ROBOT)


def test_servo_log_whose_array_header_is_larger_than_its_file_is_rejected(tmp_path):
    path, header = tmp_path / "lie.npz", io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (1 << 50,)})
    with ZipFile(path, "w") as whole:
        whole.writestr("times.npy", header.getvalue() + bytes(8))
    with pytest.raises(ConfigError, match=r"lie\.npz: no log"):
        read_log(path, ROBOT)
