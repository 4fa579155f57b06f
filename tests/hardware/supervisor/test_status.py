import json
from pathlib import Path

from kinesic.hardware.supervisor.channel import Note
from kinesic.hardware.supervisor.status import EventLog


def test_every_event_is_a_line(tmp_path: Path):
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


def test_a_file_goes_on(tmp_path: Path):
    path = tmp_path / "events.jsonl"
    for _ in range(2):
        journal = EventLog(path)
        journal.write(Note(1.0, -1, "stage", "x"))
        journal.close()
    assert len(path.read_text().splitlines()) == 2


def test_without_a_file_and_on_a_full_disk_nothing_happens():
    for path in (None, Path("/dev/full")):
        journal = EventLog(path)
        journal.write(Note(1.0, -1, "stage", "x"))
        journal.write(Note(1.0, -1, "stage", "x"))
        journal.close()
