"""Results on a full disk: one error line, and no incomplete file.

A limit on the file size of this process simulates the full disk.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from resource import RLIMIT_FSIZE, getrlimit, setrlimit

import pytest

from kinesic.cli.servos.summary import warn_of_lost_events
from kinesic.hardware.supervisor.notes import Note

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@contextmanager
def limited_file_size(octets: int) -> Iterator[None]:
    """Limit the size of files that this process writes."""
    previous = getrlimit(RLIMIT_FSIZE)
    setrlimit(RLIMIT_FSIZE, (octets, previous[1]))
    try:
        yield
    finally:
        setrlimit(RLIMIT_FSIZE, previous)


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".bap"])
def test_motion_file_is_complete_or_missing_on_a_full_disk(kinesic, tmp_path: Path, suffix: str):
    with limited_file_size(1000):
        ended = kinesic("plan", "-", "--out", f"nod{suffix}", stdin=NOD.encode())
    assert (ended.code, ended.out, ended.err) == (2, "", f"kinesic: nod{suffix}: File too large\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("octets", "path"), [(50, "out"), (30_000, "out/report.html")])
def test_report_is_complete_or_missing_on_a_full_disk(kinesic, tmp_path: Path, octets: int, path: str):
    with limited_file_size(octets):
        ended = kinesic("perform", "-", "--no-film", "--out", "out", stdin=NOD.encode())
    assert (ended.code, ended.out, ended.err) == (2, "", f"kinesic: {path}: File too large\n")
    assert list(tmp_path.iterdir()) == []


def test_lost_servo_events_are_reported_in_one_line(capsys: pytest.CaptureFixture[str]):
    warn_of_lost_events([Note(1.0, -1, "stage", "limp -> arm"), Note(2.0, -1, "journal", "events are lost")])
    assert capsys.readouterr().err == "events are lost\n"
