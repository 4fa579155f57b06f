import json
import sys

import duckdb
import numpy as np
import pytest

from kinesic.capture.read import read_clip
from kinesic.capture.reading import lerobot
from kinesic.capture.reading.text import CaptureError

from ..lerobot_files import write_dataset


def test_first_episode_of_a_lerobot_dataset_is_read_with_its_joint_names(tmp_path):
    clip = read_clip(write_dataset(tmp_path))
    assert clip.names == ("pan", "tilt")
    assert clip.times == pytest.approx(np.arange(20) / 50, abs=1e-6)
    assert clip.angles == pytest.approx(np.outer(np.arange(20), [0.01, 0.02]) + 4.0, abs=1e-6)
    assert clip.guesses == (
        "episode 4, the first of 2",
        "action read as radians; the dataset does not state its unit",
    )


def test_lerobot_angles_beyond_a_full_turn_are_read_as_degrees(tmp_path):
    clip = read_clip(write_dataset(tmp_path, scale=2.0, episodes=1))
    assert clip.angles == pytest.approx(np.radians(np.outer(np.arange(20), [2.0, 4.0]) + 4.0), abs=1e-6)
    assert clip.guesses == ("action read as degrees; the dataset does not state its unit",)


def test_lerobot_states_are_read_if_actions_are_missing(tmp_path):
    names = {"motors": ["pan", "tilt"]}
    path = write_dataset(tmp_path, feature="observation.state", episodes=1)
    description = tmp_path / "meta" / "info.json"
    dataset = json.loads(description.read_text())
    dataset["features"]["observation.state"]["names"] = names
    description.write_text(json.dumps(dataset))
    clip = read_clip(path)
    assert clip.names == ("pan", "tilt")
    assert clip.guesses[0].startswith("observation.state read as radians")


def test_lerobot_dataset_without_description_or_joints_is_refused(tmp_path):
    path = write_dataset(tmp_path)
    description = tmp_path / "meta" / "info.json"
    description.write_text('{"features": {"action": {"names": null}}}')
    with pytest.raises(CaptureError, match=r"info.json: it names the joints of neither action nor observation.state"):
        read_clip(path)
    description.unlink()
    with pytest.raises(CaptureError, match=r"info.json: No such file"):
        read_clip(path)


def test_damaged_or_missing_parquet_file_is_refused_with_its_name(tmp_path):
    path = write_dataset(tmp_path)
    path.write_bytes(b"PAR1" + path.read_bytes()[9:])
    with pytest.raises(CaptureError, match=r"file-000.parquet: "):
        read_clip(path)
    path.unlink()
    with pytest.raises(CaptureError, match=r"file-000.parquet: No such file"):
        read_clip(path)


@pytest.mark.parametrize(
    ("query", "message"),
    [
        ("SELECT 0.0 AS timestamp, [1.0] AS action, 0 AS frame_index, 0 AS episode_index", "2 values of action"),
        ("SELECT NULL AS timestamp, [1, 2] AS action, 0 AS frame_index, 0 AS episode_index", "needs a timestamp"),
        ("SELECT 0.0 AS timestamp, [1, NULL] AS action, 0 AS frame_index, 0 AS episode_index", "2 values of action"),
        ("SELECT 0.0 AS timestamp, [1, 'nan'::FLOAT] AS action, 0 AS frame_index, 0 AS episode_index", "1 frames"),
        ("SELECT 0 AS episode_index WHERE false", "it has no episode"),
        ("SELECT 0 AS episode_index", 'column "timestamp" not found'),
    ],
)
def test_lerobot_rows_without_positions_are_refused(tmp_path, query, message):
    path = write_dataset(tmp_path)
    with duckdb.connect() as connection:
        connection.execute(f"COPY ({query}) TO '{path}' (FORMAT parquet)")
    with pytest.raises(CaptureError, match=rf"file-000.parquet: .*{message}"):
        read_clip(path)


def test_missing_duckdb_is_reported_with_the_extra_that_installs_it(tmp_path, monkeypatch):
    path = write_dataset(tmp_path)
    monkeypatch.setitem(sys.modules, "duckdb", None)
    with pytest.raises(CaptureError, match=r"\.parquet needs DuckDB: .*kinesic\[store\]"):
        read_clip(path)


def test_damaged_lerobot_file_is_refused_if_duckdb_states_no_reason(tmp_path, monkeypatch):
    def fail(*_arguments: object) -> None:
        raise duckdb.BinderException("")

    monkeypatch.setattr(lerobot, "_query", fail)
    with pytest.raises(CaptureError, match="it is damaged"):
        read_clip(write_dataset(tmp_path))
