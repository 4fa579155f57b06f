"""Benchmark of captured motion."""

import pytest

from kinesic.bench import capture
from kinesic.bench.capture import imported_robots
from kinesic.bench.capture.imported_robots import ROBOT_FILES

from ...capture.clips import bvh, reach


def test_capture_benchmark_certifies_clips_and_counts_unreadable_files(tmp_path, known):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "calm.bvh").write_bytes(bvh(reach(240, height=40)))
    (tmp_path / "fast.bvh").write_bytes(bvh(reach(40, height=90, speed=2.5)))
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    metrics = {m.name: m.value for m in capture.robot_metrics("upper22", capture.list_clips(tmp_path), known)}
    assert metrics["capture.upper22.clips"] == 2
    assert metrics["capture.upper22.unread"] == 1
    assert metrics["capture.upper22.violating_before"] == 0.5
    assert metrics["capture.upper22.not_certified"] == 0
    assert metrics["capture.upper22.violating_after"] == metrics["capture.upper22.penetrating"] == 0
    assert 0.0 < metrics["capture.upper22.frechet"] < 10.0
    assert metrics["capture.upper22.correlation_p5"] > 0.9
    assert 0.0 < metrics["capture.upper22.elbow_p95"] < 30.0
    assert metrics["capture.upper22.real_time"] > 0.0


def test_capture_folder_without_readable_clips_gives_a_null_metric_with_a_reason(tmp_path, known):
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    (metric,) = capture.robot_metrics("upper22", capture.list_clips(tmp_path), known)
    assert metric.value is None
    assert "broken.bvh" in metric.why


def test_missing_corpus_gives_a_null_clip_metric(monkeypatch):
    monkeypatch.setattr(capture, "find_corpus", lambda: None)
    (metric,) = capture.bench()
    assert (metric.name, metric.value) == ("capture.clips", None)


def test_robot_without_an_installed_model_package_gives_a_null_metric_with_a_reason(monkeypatch):
    monkeypatch.setattr(capture, "COMPARED_ROBOTS", ())
    monkeypatch.setattr(imported_robots, "WHEEL_NAME", "no-such-distribution")
    metrics = capture.bench_robots([])
    assert [(m.name, m.value) for m in metrics] == [(f"capture.{name}.clips", None) for name in ROBOT_FILES]
    assert all("robots" in metric.why for metric in metrics)


def test_mink_motion_is_judged_by_all_limits_and_separately_by_the_limits_that_mink_knows(tmp_path, known):
    pytest.importorskip("mink", reason="the extra bench is not installed")
    (tmp_path / "fast.bvh").write_bytes(bvh(reach(40, height=90, speed=2.5)))
    metrics = {m.name: m.value for m in capture.robot_metrics("upper22", capture.list_clips(tmp_path), known)}
    assert metrics["capture.upper22.peer_violating"] == 1.0
    assert metrics["capture.upper22.peer_beyond_own"] == 0.0
    assert metrics["capture.upper22.peer_ratio"] > 1.001
    assert metrics["capture.upper22.peer_correlation_p5"] > 0.9
