"""Small LeRobot datasets for tests."""

import json
from pathlib import Path

import duckdb

NAMES = ("pan.pos", "tilt.pos")


def write_dataset(folder: Path, *, names=NAMES, feature="action", frames=20, scale=0.01, episodes=2) -> Path:
    """Write a dataset at 50 Hz and return the path of its data file.

    Joint k has the angle `scale` (k + 1) times the index of the frame, plus the index of the episode.
    """
    (folder / "meta").mkdir(parents=True)
    features = {feature: {"dtype": "float32", "shape": [len(names)], "names": names}, "timestamp": {"names": None}}
    (folder / "meta" / "info.json").write_text(json.dumps({"codebase_version": "v3.0", "features": features}))
    path = folder / "data" / "chunk-000" / "file-000.parquet"
    path.parent.mkdir(parents=True)
    columns = ", ".join(f"({scale} * {k + 1} * frame + episode)::FLOAT" for k in range(len(names)))
    with duckdb.connect() as connection:
        connection.execute(
            f'COPY (SELECT [{columns}] AS "{feature}", (frame / 50.0)::FLOAT AS "timestamp", frame AS frame_index, '
            f"episode AS episode_index FROM range({frames}) f(frame), range(4, {4 + episodes}) e(episode)) "
            f"TO '{path}' (FORMAT parquet)"
        )
    return path
