"""Output of `kinesic servos scan`, with simulated answers of the servos."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kinesic.cli.servos import scan
from kinesic.hardware.protocol.device import PingReply
from kinesic.hardware.protocol.models import ALL_BAUD_RATES
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.tools.survey import FoundServo

ELBOW, STRANGER = PingReply(15, 1020, 52), PingReply(200, 1060, 45)


@pytest.fixture
def tried(monkeypatch):
    """Simulate two servos per port, and record each scan's baud rate."""
    calls: list[tuple[int, int]] = []

    def scan_bus(opened, *, bauds, ids, heard):
        (rate,) = bauds
        calls.append((rate, len(ids)))
        if rate == 4_000_000:
            raise BusError("dear port: no 4000000 baud")
        found = (FoundServo(ELBOW, rate, shared=False), FoundServo(STRANGER, rate, shared=True))
        return found if rate == 1_000_000 else ()

    monkeypatch.setattr(scan, "scan_bus", scan_bus)
    monkeypatch.setattr(scan, "ports_here", lambda: ())
    return calls


def test_scan_lists_each_servo_with_its_joint_or_a_note_about_a_duplicate_id(tried, capsys):
    assert scan.scan_ports("upper22", ("body=/dev/mine",), (4_000_000, 1_000_000, 57_600), False, False) == 0
    printed = capsys.readouterr()
    lines = [line.split() for line in printed.out.splitlines()]
    assert ["mine", "1000000", "15", "xm430_w350", "52", "Protocol", "2.0", "l_elbow_flexion"] in lines
    stranger = ["mine", "1000000", "200", "xl430_w250", "45", "Protocol", "2.0", "-"]
    assert [*stranger, *["several", "servos", "have", "this", "id"]] in lines
    assert printed.out.splitlines()[-1] == "2 servos"
    assert printed.err == "dear port: no 4000000 baud\n"
    assert tried == [(57_600, 0), (1_000_000, 0), (4_000_000, 0)]


def test_scan_prints_json_and_tries_all_baud_rates_and_ids(tried, capsys):
    assert scan.scan_ports("upper22", ("/dev/mine",), (), True, True) == 0
    row = {"port": str(Path("/dev/mine")), "baud": 1_000_000, "id": 15, "model": "xm430_w350"}
    assert json.loads(capsys.readouterr().out)[0] == row | {"firmware": 52, "shared": False, "protocol": "Protocol 2.0"}
    assert [rate for rate, _ in tried][:2] == [57_600, 1_000_000]
    assert sorted(rate for rate, _ in tried) == sorted(ALL_BAUD_RATES)
    assert {ids for _, ids in tried} == {253}


def test_scan_refuses_missing_ports_and_unsupported_baud_rates(tried):
    with pytest.raises(scan.ConfigError, match="no USB serial port here"):
        scan.scan_ports("upper22", (), (), False, False)
    with pytest.raises(scan.ConfigError, match="--baud is 1234, must be one of"):
        scan.scan_ports("upper22", ("/dev/mine",), (57_600, 1234), False, False)
    with pytest.raises(BusError, match="dear port"):
        scan.scan_ports("upper22", ("/dev/mine",), (4_000_000,), False, False)


def test_scan_progress_counts_each_port_at_each_baud_rate(monkeypatch, tried):
    shown: list[object] = []

    @contextmanager
    def record(label: str, total: int) -> Iterator[Callable[[], None]]:
        shown.append((label, total))
        yield lambda: shown.append("step")
        shown.append("closed")

    monkeypatch.setattr(scan, "show_steps", record)
    scan.scan_ports("upper22", ("/dev/a", "/dev/b"), (1_000_000, 57_600, 4_000_000), False, True)
    assert shown == [("scanning", 6), *["step"] * 6, "closed"]


def test_scan_opens_each_port_at_each_baud_rate(monkeypatch, capsys):
    opened: list[tuple[Path, int]] = []

    def scan_bus(open_wire, *, bauds, ids, heard):
        opened.append(open_wire(bauds[0]))
        return ()

    monkeypatch.setattr(scan, "scan_bus", scan_bus)
    monkeypatch.setattr(scan, "SerialWire", lambda path, baud: (path, baud))
    monkeypatch.setattr(scan, "ports_here", lambda: (Path("/dev/a"), Path("/dev/b")))
    assert scan.scan_ports("upper22", (), (1_000_000, 57_600), False, False) == 0
    assert opened == [(Path(f"/dev/{name}"), rate) for name in "ab" for rate in (57_600, 1_000_000)]
    assert capsys.readouterr().out.splitlines()[-1] == "0 servos"


def test_scan_with_option_json_prints_only_json(tried, capsys):
    scan.scan_ports("upper22", ("/dev/mine",), (1_000_000,), False, True)
    printed = capsys.readouterr()
    assert printed.out.startswith('[\n {\n  "port": ')
    assert [row["shared"] for row in json.loads(printed.out)] == [False, True]
    assert printed.err == ""


def test_scan_explains_a_dead_bus_and_unknown_bytes(monkeypatch, capsys):
    octets = 0

    def scan_bus(opened, *, bauds, ids, heard):
        heard[bauds[0]] = octets
        return ()

    monkeypatch.setattr(scan, "scan_bus", scan_bus)
    assert scan.scan_ports("upper22", ("/dev/mine",), (1_000_000,), False, False) == 0
    assert "no byte came back at any baud rate; is the power on" in capsys.readouterr().err
    octets = 7
    assert scan.scan_ports("upper22", ("/dev/mine",), (1_000_000,), False, False) == 0
    assert "bytes came back at 1000000 baud, but no packet of a known protocol" in capsys.readouterr().err
