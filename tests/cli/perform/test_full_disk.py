"""Results on a disk that is full: one line says which is lost, and no half of one is left.

The size that files of this process may have stands for the disk.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from resource import RLIMIT_FSIZE, getrlimit, setrlimit

import pytest

from kinesic.cli.servos.summary import warn_of_lost_events
from kinesic.hardware.supervisor.channel import Note

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@contextmanager
def room(octets: int) -> Iterator[None]:
    """A disk on which no file becomes larger."""
    usual = getrlimit(RLIMIT_FSIZE)
    setrlimit(RLIMIT_FSIZE, (octets, usual[1]))
    try:
        yield
    finally:
        setrlimit(RLIMIT_FSIZE, usual)


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".bap"])
def test_a_motion_is_whole_or_not_there(kinesic, tmp_path: Path, suffix: str):
    with room(1000):
        ended = kinesic("plan", "-", "--out", f"nod{suffix}", stdin=NOD.encode())
    assert (ended.code, ended.out, ended.err) == (2, "", f"kinesic: nod{suffix}: File too large\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("octets", "what"), [(50, "out"), (30_000, "out/report.html")])
def test_a_report_is_whole_or_not_there(kinesic, tmp_path: Path, octets: int, what: str):
    with room(octets):
        ended = kinesic("perform", "-", "--no-film", "--out", "out", stdin=NOD.encode())
    assert (ended.code, ended.out, ended.err) == (2, "", f"kinesic: {what}: File too large\n")
    assert list(tmp_path.iterdir()) == []


def test_lost_events_are_one_line(capsys: pytest.CaptureFixture[str]):
    warn_of_lost_events([Note(1.0, -1, "stage", "limp -> arm"), Note(2.0, -1, "journal", "events are lost")])
    assert capsys.readouterr().err == "events are lost\n"
