"""Performer with servos: one run with voice, until stopped."""

from contextlib import contextmanager
from dataclasses import dataclass, field

import pytest

import kinesic
from kinesic import performer as front_door
from kinesic.controller import servo_performance, soundtrack
from kinesic.hardware import servos as hardware

NOD = '<bml id="b"><head id="nod" lexeme="NOD" stroke="0.8"/></bml>'
PORTS = {"body": "/dev/nowhere"}


@dataclass
class Hardware:
    """Stub of complete servos that records its calls."""

    checked: list = field(default_factory=list)
    performed: list = field(default_factory=list)
    stopped: bool = False
    said: list = field(default_factory=list)


@pytest.fixture
def servos(monkeypatch) -> Hardware:
    result = Hardware()

    @contextmanager
    def open_speaker(warn):
        warn("no loudspeaker")
        yield

    @contextmanager
    def speak_along(plan, warn):
        result.said.append(plan)
        with open_speaker(warn):
            yield f"voice of {len(result.said)}"

    @contextmanager
    def catch_interrupts():
        yield lambda: result.stopped

    def perform_live(run, robot, *, requested, shown):
        result.performed.append((run, robot, shown))
        before = requested()
        result.stopped = True
        return before, requested()

    monkeypatch.setattr(hardware, "check_ports", lambda robot, manifest, ports: result.checked.append((robot, ports)))
    monkeypatch.setattr(hardware, "Servos", lambda robot, ports, *, settings: (robot, ports))
    monkeypatch.setattr(servo_performance, "catch_interrupts", catch_interrupts)
    monkeypatch.setattr(servo_performance, "perform_live", perform_live)
    monkeypatch.setattr(soundtrack, "speak_along", speak_along)
    return result


@pytest.fixture(scope="module")
def performer() -> kinesic.Performer:
    return kinesic.Performer("upper22")


def test_performer_on_servos_passes_ports_voice_and_an_interrupt_to_the_servos(performer, servos, monkeypatch):
    kept = []
    monkeypatch.setattr("kinesic.report.run.performance_of", _kept(kept))
    plan = performer.plan(NOD)
    with pytest.warns(UserWarning, match="no loudspeaker") as warned:
        performer.perform(plan, on="servos", ports=PORTS)
    assert [warning.filename for warning in warned] == [__file__], "the warning names the call of `perform`"
    assert servos.checked == [(performer.robot, PORTS)]
    ((run, robot, shown),) = servos.performed
    assert run.plan is plan
    assert robot == (performer.robot, PORTS)
    assert shown == "voice of 1"
    assert servos.said == [plan]
    assert [item.get("servos") for item in kept] == [None, ("go on", "end")]


def _kept(kept: list):
    from kinesic.report.run import performance_of  # noqa: PLC0415 - before it is replaced

    def of(found, **named):
        kept.append(named)
        return performance_of(found, **{name: each for name, each in named.items() if name != "servos"})

    return of


def test_performer_checks_the_serial_ports_before_motion(performer, servos, monkeypatch):
    def refuse(robot, manifest, ports):
        raise kinesic.BusError("no such port")

    monkeypatch.setattr(hardware, "check_ports", refuse)
    monkeypatch.setattr(front_door, "dry_runs", lambda *given, **named: pytest.fail("nothing may perform"))
    with pytest.raises(kinesic.BusError, match="no such port"):
        performer.perform(NOD, on="servos", ports=PORTS)
    assert servos.performed == []


@pytest.mark.parametrize("film", [True, False])
def test_report_film_is_drawn_unless_film_is_false(performer, monkeypatch, tmp_path, film: bool):
    asked = []
    monkeypatch.setattr(kinesic.Performance, "report", lambda run, folder, *, film: asked.append((folder, film)))
    run = performer.perform(NOD)
    assert performer.report(run, tmp_path, **({} if film else {"film": False})) is run
    assert asked == [(tmp_path, film)]
