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
NAMES = np.array(ROBOT.skeleton.names)
TIMES = np.array([0.0, 0.01, 0.02])
ANGLES = np.arange(66.0).reshape(3, 22) / 100
WHOLE = {"times": TIMES, "names": NAMES, "goals": ANGLES + 1, "angles": ANGLES}


def test_what_a_twin_saw_is_written_and_read(tmp_path):
    twin, still = Twin(ROBOT), np.zeros(22)
    for time in TIMES:
        twin.write(Command(time, ROBOT.skeleton.rest, still, still, ROBOT.skeleton.rest + 0.01))
    seen = twin.measurements()
    write_log(seen, ROBOT, tmp_path / "measured.npz")
    log = read_log(tmp_path / "measured.npz", ROBOT)
    for name in ("times", "goals", "angles"):
        assert np.array_equal(getattr(log, name), getattr(seen, name))


def test_hinges_may_come_in_any_order(tmp_path):
    order = np.random.default_rng(0).permutation(22)
    shuffled = {"names": NAMES[order], "goals": ANGLES[:, order] + 1, "angles": ANGLES[:, order]}
    np.savez(tmp_path / "log.npz", **{**WHOLE, **shuffled})
    log = read_log(tmp_path / "log.npz", ROBOT)
    assert np.array_equal(log.angles, ANGLES)
    assert np.array_equal(log.goals, ANGLES + 1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"goals": None}, "lacks goals; a log is npz with times"),
        ({"names": np.array(["x", *NAMES[1:]])}, "lacks 1 hinges of upper22, first vl5_torsion"),
        ({"angles": ANGLES[:2]}, r"angles is \(2, 22\), must be \(3, 22\)"),
        ({"angles": ANGLES * np.nan}, "angles holds a number that is not finite"),
        ({"times": TIMES[::-1]}, "times must be at least two, and increase"),
        ({"times": TIMES[[0, 0, 1]]}, "times must be at least two, and increase"),
    ],
)
def test_what_is_no_log_is_refused_with_what_would_be_one(tmp_path, change, message):
    data = {name: values for name, values in {**WHOLE, **change}.items() if values is not None}
    np.savez(tmp_path / "log.npz", **data)
    with pytest.raises(ConfigError, match=message):
        read_log(tmp_path / "log.npz", ROBOT)


def test_a_missing_file_and_another_kind_of_file_are_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"none\.npz: No such file"):
        read_log(tmp_path / "none.npz", ROBOT)
    text = tmp_path / "text.npz"
    text.write_text("times")
    with pytest.raises(ConfigError, match="no log; a log is npz"):
        read_log(text, ROBOT)


def test_a_log_that_unpacks_without_end_is_refused_before_it_is(tmp_path, monkeypatch):
    monkeypatch.setattr(log, "LARGEST_LOG", 50_000_000)
    path = tmp_path / "bomb.npz"
    with ZipFile(path, "w", ZIP_DEFLATED) as whole, whole.open("angles.npy", "w") as part:
        for _ in range(60):
            part.write(bytes(1_000_000))
    assert path.stat().st_size < 100_000
    with pytest.raises(ConfigError, match=r"bomb\.npz: unpacks to 60 MB, at most 50 are read"):
        read_log(path, ROBOT)


def test_an_array_that_claims_to_be_larger_than_its_file_is_no_log(tmp_path):
    path, header = tmp_path / "lie.npz", io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (1 << 50,)})
    with ZipFile(path, "w") as whole:
        whole.writestr("times.npy", header.getvalue() + bytes(8))
    with pytest.raises(ConfigError, match=r"lie\.npz: no log"):
        read_log(path, ROBOT)
