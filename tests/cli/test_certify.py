"""Verb `kinesic certify`."""

import json
from pathlib import Path

import numpy as np
import pytest
from click import UsageError

import kinesic
from kinesic.body.config import ConfigError
from kinesic.capture.reading.text import CaptureError
from kinesic.cli import kinesic as command

from ..capture.clips import bvh, joint_csv, reach
from ..capture.independent_limits import assert_within_limits


@pytest.fixture(autouse=True)
def clips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two clips in the current folder, of which one is fast."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "calm.bvh").write_bytes(bvh(reach(240, height=40)))
    (tmp_path / "fast.bvh").write_bytes(bvh(reach(40, height=90, speed=2.5)))
    return tmp_path


def certify(*arguments: str) -> int:
    return command(["certify", *arguments], standalone_mode=False)


def test_certify_with_option_check_accepts_a_feasible_motion(capsys):
    assert certify("calm.bvh", "--check") == 0
    out = capsys.readouterr().out
    assert "calm.bvh on upper22: 7.96 s" in out
    assert "violates no limit" in out
    assert "nearest" not in out


def test_certify_with_option_check_names_joint_and_limit_of_a_too_fast_motion(capsys):
    assert certify("fast.bvh", "--check") == 1
    out = capsys.readouterr().out
    assert "r_shoulder" in out
    assert "jerk" in out


def test_nearest_feasible_motion_is_written_and_passes_option_check(capsys):
    assert certify("fast.bvh", "--out", "near.npz") == 0
    out = capsys.readouterr().out
    assert "nearest motion: within all limits" in out
    assert out.endswith("motion: near.npz\n")
    assert certify("near.npz", "--check") == 0
    with pytest.raises(ConfigError, match=r"near\.npz"):
        certify("fast.bvh", "--out", "near.npz")


def test_certify_json_lists_limit_violations_and_the_correlation_of_motion_and_clip(capsys):
    assert certify("fast.bvh", "--robot", "upper36", "--json") == 0
    record = json.loads(capsys.readouterr().out)
    assert record["robot"] == "upper36"
    assert record["certified"] is True
    assert record["limit_ratio"] <= 1.001
    assert {"limit", "part", "time", "ratio", "fraction"} == record["violations"][0].keys()
    assert record["correlation"] > 0.9


def test_certify_refuses_option_check_together_with_an_output_file():
    with pytest.raises(UsageError, match="--check"):
        certify("calm.bvh", "--check", "--out", "a.npz")


def test_unreadable_capture_file_is_refused_with_its_line(clips):
    (clips / "bad.csv").write_bytes(joint_csv().replace(b"\n0.02,", b"\nx,"))
    with pytest.raises(CaptureError, match=r"bad\.csv:3"):
        certify("bad.csv")


def test_certify_function_returns_and_saves_a_motion_within_limits(known, clips):
    result = kinesic.certify("fast.bvh", known)
    assert result.is_certified
    assert_within_limits(result.trajectory, known.limits)
    path = result.save(clips / "near.csv")
    assert np.loadtxt(path, delimiter=",", skiprows=1).shape[1] == 1 + len(known.robot.skeleton.names)


def test_bvh_clip_is_performed_and_reported_like_a_document(clips):
    assert command(["perform", "fast.bvh", "--no-film", "--out", "report"], standalone_mode=False) == 0
    report = json.loads((clips / "report" / "report.json").read_text())
    assert report["ok"] is True
    warnings = " ".join(str(warning) for warning in report["warnings"])
    assert "times as long" in warnings
