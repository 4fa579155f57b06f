"""LeRobot datasets, read by DuckDB and by kinesic's own reader."""

import json
from dataclasses import replace
from pathlib import Path

import duckdb
import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.capture.reading.lerobot import read_lerobot
from kinesic.metrics.dry_run import DryRun
from kinesic.report.export.lerobot_dataset import save_lerobot
from kinesic.report.export.recording import ExportedMotion

DATA_FILE = "data/chunk-000/file-000.parquet"


@pytest.fixture(scope="module")
def motions(hurried: DryRun) -> list[ExportedMotion]:
    """A performance with words, and its plan without words."""
    return [ExportedMotion.of_performance(hurried), replace(ExportedMotion.of_plan(hurried.plan), words=())]


@pytest.fixture(scope="module")
def dataset(motions: list[ExportedMotion], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lerobot") / "mine"
    save_lerobot(motions, folder, force=False)
    return folder


def rows(path: Path, columns: str) -> list[tuple]:
    return duckdb.sql(f"SELECT {columns} FROM '{path}'").fetchall()


def test_frames_have_degrees_at_50_hz_with_the_measured_state(dataset: Path, motions: list[ExportedMotion]):
    frames = rows(dataset / DATA_FILE, '"action", "observation.state", "timestamp", "frame_index" ')
    first = motions[0]
    count = len(first.times[::2])
    actions, states, times, indices = (np.array(column) for column in zip(*frames[:count], strict=True))
    assert first.measured is not None
    np.testing.assert_allclose(actions, np.degrees(first.planned.angles[::2]), atol=1e-4)
    np.testing.assert_allclose(states, np.degrees(first.measured.angles[::2]), atol=1e-4)
    np.testing.assert_allclose(times, np.arange(count) / 50, atol=1e-5)
    assert indices.tolist() == list(range(count))


def test_plan_without_performance_has_its_actions_as_states(dataset: Path):
    frames = rows(dataset / DATA_FILE, '"action" = "observation.state", episode_index')
    assert all(equal for equal, episode in frames if episode == 1)


def test_episodes_follow_each_other_with_their_tasks(dataset: Path, motions: list[ExportedMotion]):
    episodes = rows(
        dataset / "meta/episodes/chunk-000/file-000.parquet",
        'episode_index, length, dataset_from_index, dataset_to_index, tasks, "stats/action/max"',
    )
    counts = [len(motion.times[::2]) for motion in motions]
    tasks = dict(rows(dataset / "meta/tasks.parquet", "task_index, task"))
    assert [row[:4] for row in episodes] == [(0, counts[0], 0, counts[0]), (1, counts[1], counts[0], sum(counts))]
    assert [row[4] for row in episodes] == [[tasks[0]], [tasks[1]]]
    assert tasks[0] == "perform gestures" or "  " not in tasks[0]
    assert tasks[1] == "perform gestures"
    indices = rows(dataset / DATA_FILE, '"index", episode_index, task_index')
    assert [index for index, _, _ in indices] == list(range(sum(counts)))
    assert {(episode, task) for _, episode, task in indices} == {(0, 0), (1, 1)}
    assert episodes[0][5] == pytest.approx(np.degrees(motions[0].planned.angles[::2]).max(axis=0), abs=1e-4)


def test_description_states_names_types_and_numbers_of_the_data(dataset: Path, motions: list[ExportedMotion]):
    info = json.loads((dataset / "meta" / "info.json").read_text())
    robot = motions[0].robot
    assert info["codebase_version"] == "v3.0"
    assert info["fps"] == 50
    assert info["robot_type"] == f"kinesic_{robot.name}"
    assert info["total_frames"] == sum(len(motion.times[::2]) for motion in motions)
    assert info["splits"] == {"train": "0:2"}
    assert info["data_path"].format(chunk_index=0, file_index=0) == DATA_FILE
    assert info["features"]["action"]["names"] == [f"{name}.pos" for name in robot.source_joints.names]
    stored = dict(
        duckdb.sql(f"SELECT column_name, column_type FROM (DESCRIBE FROM '{dataset / DATA_FILE}')").fetchall()
    )
    sql = {"float32": "FLOAT", "int64": "BIGINT"}
    expected = {
        name: sql[feature["dtype"]] + ("" if feature["shape"] == [1] else "[]")
        for name, feature in info["features"].items()
    }
    assert stored == expected


def test_statistics_are_those_of_all_frames(dataset: Path):
    statistics = json.loads((dataset / "meta" / "stats.json").read_text())
    actions = np.array([row[0] for row in rows(dataset / DATA_FILE, '"action"')])
    assert statistics["action"]["mean"] == pytest.approx(actions.mean(axis=0), abs=1e-4)
    assert statistics["action"]["std"] == pytest.approx(actions.std(axis=0), abs=1e-4)
    assert statistics["action"]["q10"] == pytest.approx(np.quantile(actions, 0.1, axis=0), abs=1e-4)
    assert statistics["action"]["count"] == [len(actions)]
    assert statistics["index"]["min"] == [0.0]


def test_pandas_takes_the_task_as_the_index_of_the_tasks(dataset: Path):
    metadata = duckdb.sql(f"SELECT value FROM parquet_kv_metadata('{dataset}/meta/tasks.parquet')").fetchall()
    assert json.loads(metadata[0][0])["index_columns"] == ["task"]


def test_dataset_is_read_back_as_the_planned_motion(dataset: Path, motions: list[ExportedMotion]):
    clip = read_lerobot(dataset / DATA_FILE)
    assert clip.names == motions[0].robot.source_joints.names
    np.testing.assert_allclose(clip.angles, motions[0].planned.angles[::2], atol=1e-6)
    assert clip.guesses == ("episode 0, the first of 2",)


def test_motions_of_different_robots_and_existing_folders_are_refused(
    dataset: Path, motions: list[ExportedMotion], tmp_path: Path
):
    with pytest.raises(ConfigError, match="exists already"):
        save_lerobot(motions, dataset, force=False)
    with pytest.raises(ConfigError, match="needs one or more motions of the same robot"):
        save_lerobot([], tmp_path / "b", force=False)
