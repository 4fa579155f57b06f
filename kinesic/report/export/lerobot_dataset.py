"""Datasets of LeRobot (version 3): performances as episodes with actions and states.

Positions are in degrees, with the joint names and zeros of the robot's own file.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE
from kinesic.body.config import ConfigError
from kinesic.files.output_folder import new_folder
from kinesic.report.export.recording import ExportedMotion

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

DATASET_RATE = 50  # [Hz] frames per second
DATASET_VERSION = "v3.0"  # version of the format
DATA_FILE = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"  # path of frames, as the format names it
EPISODE_FILE = "meta/episodes/chunk-000/file-000.parquet"
TASK_FILE = "meta/tasks.parquet"
ROBOT_TYPE = "kinesic_{}"  # type of the robot: tells readers that positions are in degrees
STATISTIC_QUANTILES: Mapping[str, float] = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
SCALAR_COLUMNS: Mapping[str, str] = {  # columns with one number -> type
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
SQL_TYPES: Mapping[str, str] = {"float32": "FLOAT", "int64": "BIGINT"}
TASK_INDEX = {  # description by which pandas takes the task as the index of its table
    "index_columns": ["task"],
    "column_indexes": [],
    "columns": [
        {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"},
        {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object"},
    ],
    "pandas_version": "2.0.0",
}

Columns = Mapping[str, NDArray[np.generic]]
Statistics = dict[str, dict[str, list[float]]]  # column -> statistic -> value of each component


def save_lerobot(motions: Sequence[ExportedMotion], folder: Path, *, force: bool) -> None:
    """Write motions of one robot as a dataset, one episode each.

    The action is the planned position. The state is the position that the twin measured, or the planned one. The
    spoken words are the task.

    Args:
        motions: one or more.
        folder: of the dataset.
        force: whether to replace an existing folder of kinesic.

    Raises:
        ConfigError: the motions have different robots, or the folder cannot be written.
        ModuleNotFoundError: the extra `store` is missing.
    """
    import duckdb  # noqa: PLC0415 - an extra

    if not motions or len({motion.robot.source_joints.names for motion in motions}) > 1:
        raise ConfigError(f"{folder}: a dataset needs one or more motions of the same robot")
    tasks = list(dict.fromkeys(_task(motion) for motion in motions))
    episodes: list[Columns] = []
    for motion in motions:
        start = sum(len(episode["index"]) for episode in episodes)
        episodes.append(_frames(motion, len(episodes), start, tasks.index(_task(motion))))
    frames = {name: np.concatenate([episode[name] for episode in episodes]) for name in episodes[0]}
    with new_folder(folder, force=force) as place, duckdb.connect() as connection:
        for file in (DATA_FILE.format(chunk_index=0, file_index=0), EPISODE_FILE):
            (place / file).parent.mkdir(parents=True)
        _write_frames(connection, frames, place / DATA_FILE.format(chunk_index=0, file_index=0))
        _write_episodes(connection, episodes, tasks, place / EPISODE_FILE)
        _write_tasks(connection, tasks, place / TASK_FILE)
        _write_json(_info(motions[0], frames, len(motions), len(tasks)), place / "meta" / "info.json")
        _write_json(_statistics(frames), place / "meta" / "stats.json")


def _task(motion: ExportedMotion) -> str:
    """Return the spoken words, or a general task without speech."""
    words = " ".join(" ".join(word.text for word in motion.words).split())
    return f'say "{words}" with gestures' if words else "perform gestures"


def _frames(motion: ExportedMotion, episode: int, start: int, task: int) -> Columns:
    """Return the columns of an episode with first frame index `start`."""
    step, joints = COMMAND_RATE // DATASET_RATE, motion.robot.source_joints
    times = motion.times[::step]
    count = len(times)
    return {
        "action": _degrees(joints.joint_angles(motion.planned.angles[::step])),
        "observation.state": _degrees(joints.joint_angles(motion.shown.angles[::step])),
        "timestamp": (np.arange(count) / DATASET_RATE).astype(np.float32),
        "frame_index": np.arange(count),
        "episode_index": np.full(count, episode),
        "index": start + np.arange(count),
        "task_index": np.full(count, task),
    }


def _degrees(angles: Floats) -> NDArray[np.float32]:
    return np.degrees(angles).astype(np.float32)


def _write_frames(connection: "DuckDBPyConnection", frames: Columns, path: Path) -> None:
    flat: dict[str, NDArray[np.generic]] = {}
    selected = []
    for name, values in frames.items():
        parts = [f"{name}[{k}]" for k in range(values.shape[1])] if values.ndim == 2 else [name]
        flat |= dict(zip(parts, values.T if values.ndim == 2 else (values,), strict=True))
        quoted = ", ".join(f'"{part}"' for part in parts)
        selected.append(
            f'[{quoted}]::FLOAT[] AS "{name}"'
            if values.ndim == 2
            else f'{quoted}::{SQL_TYPES[SCALAR_COLUMNS[name]]} AS "{name}"'
        )
    connection.register("frames", {part: np.ascontiguousarray(values) for part, values in flat.items()})
    connection.execute(
        f'COPY (SELECT {", ".join(selected)} FROM frames ORDER BY "index") TO ? (FORMAT parquet)', [str(path)]
    )


def _write_episodes(
    connection: "DuckDBPyConnection", episodes: Sequence[Columns], tasks: Sequence[str], path: Path
) -> None:
    """Write one row for each episode, with its statistics."""
    rows = []
    for number, frames in enumerate(episodes):
        start, count = int(frames["index"][0]), len(frames["index"])
        row: dict[str, object] = {
            "episode_index": number,
            "tasks": [tasks[int(frames["task_index"][0])]],
            "length": count,
            "data/chunk_index": 0,
            "data/file_index": 0,
            "dataset_from_index": start,
            "dataset_to_index": start + count,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
        }
        for name, statistics in _statistics(frames).items():
            row |= {f"stats/{name}/{key}": values for key, values in statistics.items()}
        rows.append(row)
    _copy_rows(connection, rows, path)


def _copy_rows(connection: "DuckDBPyConnection", rows: Sequence[Mapping[str, object]], path: Path) -> None:
    """Write rows of whole numbers, texts and lists."""
    columns = ", ".join(f'"{name}" {_sql_type(name, value)}' for name, value in rows[0].items())
    connection.execute(f"CREATE OR REPLACE TEMP TABLE rows ({columns})")
    places = ", ".join("?" * len(rows[0]))
    connection.executemany(f"INSERT INTO rows VALUES ({places})", [list(row.values()) for row in rows])
    connection.execute("COPY rows TO ? (FORMAT parquet)", [str(path)])


def _sql_type(name: str, value: object) -> str:
    if name == "tasks":
        return "VARCHAR[]"
    if isinstance(value, list):
        return "BIGINT[]" if name.endswith("/count") else "DOUBLE[]"
    return "BIGINT"


def _write_tasks(connection: "DuckDBPyConnection", tasks: Sequence[str], path: Path) -> None:
    connection.execute("CREATE OR REPLACE TEMP TABLE tasks (task_index BIGINT, task VARCHAR)")
    connection.executemany("INSERT INTO tasks VALUES (?, ?)", [[k, task] for k, task in enumerate(tasks)])
    described = json.dumps(TASK_INDEX)
    connection.execute(f"COPY tasks TO ? (FORMAT parquet, KV_METADATA {{pandas: '{described}'}})", [str(path)])


def _statistics(frames: Columns) -> Statistics:
    """Return minimum, maximum, mean, deviation, count and quantiles of columns."""
    statistics: Statistics = {}
    for name, column in frames.items():
        values = column.astype(np.float64).reshape(len(column), -1)
        rows = {
            "min": values.min(axis=0),
            "max": values.max(axis=0),
            "mean": values.mean(axis=0),
            "std": values.std(axis=0),
        }
        rows |= {key: np.quantile(values, ratio, axis=0) for key, ratio in STATISTIC_QUANTILES.items()}
        statistics[name] = {key: row.tolist() for key, row in rows.items()} | {"count": [len(values)]}
    return statistics


def _info(motion: ExportedMotion, frames: Columns, episodes: int, tasks: int) -> dict[str, object]:
    """Return the description of a dataset."""
    names = [f"{name}.pos" for name in motion.robot.source_joints.names]
    joints = {"dtype": "float32", "shape": [len(names)], "names": names}
    scalars = {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in SCALAR_COLUMNS.items()}
    return {
        "codebase_version": DATASET_VERSION,
        "robot_type": ROBOT_TYPE.format(motion.robot.name),
        "total_episodes": episodes,
        "total_frames": len(frames["index"]),
        "total_tasks": tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 500,
        "fps": DATASET_RATE,
        "splits": {"train": f"0:{episodes}"},
        "data_path": DATA_FILE,
        "video_path": None,
        "features": {"action": joints, "observation.state": joints, **scalars},
    }


def _write_json(content: object, path: Path) -> None:
    path.write_text(json.dumps(content, indent=4, ensure_ascii=False) + "\n", encoding="utf-8")
