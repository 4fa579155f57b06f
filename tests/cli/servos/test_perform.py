"""Errors of `kinesic perform --on servos` that are reported before any motion."""

from pathlib import Path

import pytest

from kinesic.cli import perform
from kinesic.report.report import report

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@pytest.fixture
def nod(tmp_path: Path) -> Path:
    path = tmp_path / "nod.bml"
    path.write_text(NOD, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--on", "legs"), "'legs' is not one of twin, servos"),
        (("--on", "servos"), "no port given; add --port body=PATH"),
        (("--on", "servos", "--port", "arm=/dev/null"), "no bus arm; known: body"),
        (("--on", "twin,servos", "--port", "body=/dev/nothing"), "/dev/nothing: no such port"),
    ],
)
def test_invalid_servo_options_are_reported(kinesic, nod: Path, options: tuple[str, ...], message: str):
    ended = kinesic("perform", nod, "--no-film", *options)
    assert ended.code == 2
    assert message in ended.err.splitlines()[-1]


def test_perform_verb_does_not_move_servos_if_a_twin_check_fails(kinesic, served, nod: Path, monkeypatch):
    monkeypatch.setattr(perform, "report", lambda *given, **named: report(*given, **named) | {"ok": False})
    ended = kinesic("perform", nod, "--on", "servos", "--port", served.port, "--no-film")
    assert ended.code == 1
    assert "the servos did not move: a check of the twin failed" in ended.err
    assert served.energised == 0
