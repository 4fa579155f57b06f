"""Independent servo against the manual's printed example packets of protocol 2.0."""

import ast
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ...manual_servo import packet as p
from ...manual_servo.packet import Decoder

Make = Callable  # of a bench, see conftest
EXAMPLES = {  # bytes as the manual prints them
    "ping": (p.instruct(1, p.PING), "FF FF FD 00 01 03 00 01 19 4E"),
    "ping of all": (p.instruct(p.BROADCAST_ID, p.PING), "FF FF FD 00 FE 03 00 01 31 42"),
    "read": (p.instruct(1, p.READ, bytes.fromhex("84000400")), "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
    "write": (
        p.instruct(1, p.WRITE, bytes.fromhex("7400 00020000")),
        "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89",
    ),
    "reg write": (
        p.instruct(1, p.REG_WRITE, bytes.fromhex("6800 C8000000")),
        "FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E",
    ),
    "action": (p.instruct(1, p.ACTION), "FF FF FD 00 01 03 00 05 02 CE"),
    "factory reset": (p.instruct(1, p.FACTORY_RESET, b"\x01"), "FF FF FD 00 01 04 00 06 01 A1 E6"),
    "reboot": (p.instruct(1, p.REBOOT), "FF FF FD 00 01 03 00 08 2F 4E"),
    "clear": (p.instruct(1, p.CLEAR, bytes.fromhex("0144584C22")), "FF FF FD 00 01 08 00 10 01 44 58 4C 22 B1 DC"),
    "sync read": (
        p.instruct(p.BROADCAST_ID, p.SYNC_READ, bytes.fromhex("84000400 01 02")),
        "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
    ),
    "fast sync read": (
        p.instruct(p.BROADCAST_ID, p.FAST_SYNC_READ, bytes.fromhex("84000400 03 07 04")),
        "FF FF FD 00 FE 0A 00 8A 84 00 04 00 03 07 04 20 F2",
    ),
    "an answer without data": (p.status(1, 0), "FF FF FD 00 01 04 00 55 00 A1 0C"),
    "an answer to ping": (p.status(1, 0, bytes.fromhex("060426")), "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"),
    "an answer to read": (p.status(2, 0, bytes.fromhex("1F080000")), "FF FF FD 00 02 08 00 55 00 1F 08 00 00 BA BE"),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_reference_servo_packets_equal_those_of_the_manual(name: str):
    made, printed = EXAMPLES[name]
    assert made == bytes.fromhex(printed)


def test_header_inside_of_a_packet_is_stuffed():
    body = bytes([p.WRITE]) + bytes.fromhex("FFFFFD FD FFFFFD")
    framed = p.frame(1, body)
    assert framed[5] == len(body) + 2 + 2
    (packet,) = Decoder().feed(framed)
    assert packet.intact
    assert packet.parameters == body[1:]


def test_reference_servos_answer_a_fast_sync_read_with_the_reply_printed_in_the_manual(bench: Make):
    made = bench(3, 7, 4, model="xc330_t288")
    for device, ticks in zip(made.devices, (166, 2079, 1023), strict=True):
        device.firmware.tampers.append(lambda memory, ticks=ticks: memory.__setitem__("present_position", ticks))
    said = made.raw(EXAMPLES["fast sync read"][0])
    assert said.startswith(
        bytes.fromhex("FF FF FD 00 FE 19 00 55 00 03 A6 00 00 00 84 08 00 07 1F 08 00 00 16 CA 00 04 FF 03 00 00")
    )
    assert p.crc(said[:-2]) == int.from_bytes(said[-2:], "little")


def test_incomplete_packet_is_dropped_after_silence():
    whole, decoder = p.instruct(1, p.PING), Decoder()
    assert not decoder.feed(whole[:6], 0.0)
    assert len(decoder.feed(whole, 1.0)) == 1


def test_reference_servo_imports_only_the_standard_library():
    folder = Path(__file__).parents[2] / "manual_servo"
    files = sorted(folder.glob("*.py"))
    assert len(files) >= 9
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level <= 1, f"{file.name} reaches out of its folder"
                names = [] if node.level else [str(node.module)]
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id != "__import__", file.name
                continue
            else:
                continue
            for name in names:
                root = name.split(".")[0]
                assert root in sys.stdlib_module_names, f"{file.name} imports {name}"
                assert root != "importlib", file.name
