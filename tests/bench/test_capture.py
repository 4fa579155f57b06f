"""Benchmark of captured motion."""

from kinesic.bench import capture

from ..capture.clips import bvh, reach


def metrics_of(folder) -> dict[str, float | None]:
    return {metric.name: metric.value for metric in capture.robot_metrics("upper22", capture.list_clips(folder))}


def test_clips_are_certified_and_unreadable_files_are_counted(tmp_path):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "calm.bvh").write_bytes(bvh(reach(240, height=40)))
    (tmp_path / "fast.bvh").write_bytes(bvh(reach(40, height=90, speed=2.5)))
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    metrics = metrics_of(tmp_path)
    assert metrics["capture.upper22.clips"] == 2
    assert metrics["capture.upper22.unread"] == 1
    assert metrics["capture.upper22.violating_before"] == 0.5
    assert metrics["capture.upper22.not_certified"] == 0
    assert metrics["capture.upper22.correlation_p5"] > 0.9
    assert 0.0 < metrics["capture.upper22.elbow_p95"] < 30.0
    assert metrics["capture.upper22.real_time"] > 0.0


def test_folder_without_readable_clips_gives_a_null_metric_with_a_reason(tmp_path):
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    (metric,) = capture.robot_metrics("upper22", capture.list_clips(tmp_path))
    assert metric.value is None
    assert "broken.bvh" in metric.why


def test_missing_corpus_gives_a_null_clip_metric(monkeypatch):
    monkeypatch.setattr(capture, "find_corpus", lambda: None)
    (metric,) = capture.bench()
    assert (metric.name, metric.value) == ("capture.clips", None)
