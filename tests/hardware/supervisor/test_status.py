import json
from pathlib import Path
from resource import RLIMIT_FSIZE, getrlimit, setrlimit
from types import SimpleNamespace

import pytest

from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.status import EventLog, awaited_input


def test_event_log_has_one_line_per_event(tmp_path: Path):
    path = tmp_path / "events.jsonl"
    journal = EventLog(path)
    journal.write(Note(1.5, 3, "error", "hardware error"))
    journal.write(Note(2.5, -1, "stage", "hold -> fold (tick)"))
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    journal.close()
    assert [(line["time"], line["kind"], line.get("servo")) for line in lines] == [
        (1.5, "error", 3),
        (2.5, "stage", None),
    ]
    assert all(line["wall"] > 1e9 for line in lines)


def test_event_log_is_appended_to_an_existing_file(tmp_path: Path):
    path = tmp_path / "events.jsonl"
    for _ in range(2):
        journal = EventLog(path)
        journal.write(Note(1.0, -1, "stage", "x"))
        journal.close()
    assert len(path.read_text().splitlines()) == 2


def test_event_log_without_a_file_writes_nothing():
    journal = EventLog(None)
    journal.write(Note(1.0, -1, "stage", "x"))
    journal.close()
    assert journal.failure == ""


@pytest.mark.parametrize(
    ("path", "why"),
    [("/dev/full", "No space left on device"), ("/nowhere/events.jsonl", "No such file or directory")],
)
def test_writes_to_an_unwritable_event_log_raise_no_error_and_record_the_reason(path: str, why: str):
    journal = EventLog(Path(path))
    for _ in range(2):
        journal.write(Note(1.0, -1, "stage", "x"))
    journal.close()
    assert journal.failure == f"{path}: {why}; events are lost"


def test_full_disk_leaves_no_partial_line_in_the_event_log(tmp_path: Path):
    """A file size limit of this process stands for the full disk."""
    path, limits = tmp_path / "events.jsonl", getrlimit(RLIMIT_FSIZE)
    journal = EventLog(path)
    journal.write(Note(1.0, -1, "stage", "x"))
    whole = path.read_text()
    setrlimit(RLIMIT_FSIZE, (len(whole) + 20, limits[1]))
    try:
        for _ in range(2):
            journal.write(Note(2.0, -1, "stage", "x"))
    finally:
        setrlimit(RLIMIT_FSIZE, limits)
    assert path.read_text() == whole
    assert journal.failure.endswith("events are lost")
    journal.write(Note(3.0, -1, "stage", "x"))
    journal.close()
    assert len(path.read_text().splitlines()) == 2


@pytest.mark.parametrize(
    ("stage", "paused", "well", "waits"),
    [
        (Stage.WAITING, False, True, "confirmation"),
        (Stage.STOPPED, False, True, "consent"),
        (Stage.STOPPED, True, False, "consent"),
        (Stage.HOLD, True, True, "consent"),
        (Stage.HOLD, True, False, "consent"),
        (Stage.HOLD, False, True, "commands"),
        (Stage.HOLD, False, False, "servos"),
        (Stage.LOST, False, False, "port"),
        (Stage.LIMP, False, True, "commands"),
        (Stage.ACTIVE, False, True, "nothing"),
        (Stage.ACTIVE, True, False, "nothing"),
        (Stage.FOLD, False, False, "nothing"),
    ],
)
def test_status_names_the_input_that_each_supervisor_stage_waits_for(
    stage: Stage, paused: bool, well: bool, waits: str
):
    assert awaited_input(SimpleNamespace(stage=stage, paused=paused), well=well) == waits
