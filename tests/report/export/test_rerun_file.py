"""Recordings of the Rerun viewer, read by its own library."""

import numpy as np
import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.report.export.recording import ExportedMotion
from kinesic.report.export.rerun_file import save_rerun

chunks = pytest.importorskip("rerun.chunk", reason="the extra rerun (half a gigabyte) is not installed")
Columns = dict[str, list]


@pytest.fixture(scope="module")
def entities(hurried: DryRun, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Columns]:
    """Return the columns of each entity by name."""
    path = tmp_path_factory.mktemp("rerun") / "hurried.rrd"
    save_rerun(ExportedMotion.of_performance(hurried), path, force=False)
    results: dict[str, Columns] = {}
    for chunk in chunks.RrdReader(path).stream().to_chunks():
        columns = results.setdefault(chunk.entity_path.lstrip("/"), {})
        for name, values in chunk.to_record_batch().to_pydict().items():
            columns.setdefault(name, []).extend(values)
    return results


def column(columns: Columns, ending: str) -> np.ndarray:
    (name,) = [name for name in columns if name.endswith(ending)]
    order = np.argsort([time.total_seconds() for time in columns["performance"]], kind="stable")
    return np.array([columns[name][k] for k in order])


def test_rerun_recording_contains_planned_and_measured_joint_angles(hurried: DryRun, entities: dict[str, Columns]):
    planned = hurried.plan.trajectory.sample(hurried.measured.times)[0]
    for track, angles in (("planned", planned), ("measured", hurried.measured.angles)):
        for hinge, name in enumerate(hurried.plan.setup.robot.skeleton.names):
            result = column(entities[f"joints/{track}/{name}"], "Scalars:scalars").ravel()
            assert np.array_equal(result, angles[:, hinge])


def test_rerun_entities_of_segments_are_nested_and_contain_their_surfaces(entities: dict[str, Columns]):
    (hand,) = [name for name in entities if name.endswith("/r_wrist")]
    assert hand.startswith("world/humanoid_root/")
    assert any(name.startswith(f"{hand}/surface_") for name in entities)


def test_rerun_recording_contains_spoken_words_at_their_times(hurried: DryRun, entities: dict[str, Columns]):
    columns = entities["speech"]
    texts = column(columns, "TextLog:text").ravel().tolist()
    assert "s: Hello there," in texts
    times = sorted(time.total_seconds() for time in columns["performance"])
    assert times[0] == pytest.approx(hurried.plan.trajectory.zero, abs=0.5)
