"""Verb `kinesic servos scan`: find the servos on serial ports."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.progress import show_steps
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.hardware.bus.host import list_ports as ports_here
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import ALL_BAUD_RATES
from kinesic.hardware.protocol.packet import MAX_ID
from kinesic.hardware.protocol.servo_map import ServoMap, load_robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.tools.survey import FoundServo, scan_bus

COMMON_BAUD_RATES = (57_600, 1_000_000)  # [bit/s] factory default and usual rate of robots, tried first


def scan_ports(robot: str, ports: tuple[str, ...], bauds: tuple[int, ...], thorough: bool, as_json: bool) -> int:
    """Print the servos that answer at any baud rate.

    Nothing is changed.
    """
    hinges = {servo: row.hinge for row in ServoMap.of(load_robot(robot)).servos for servo in row.ids}
    paths = [Path(text.partition("=")[2] or text) for text in ports] or list(ports_here())
    if not paths:
        raise ConfigError("no USB serial port here; plug the adapter in, or give --port PATH")
    unknown_rates = [rate for rate in bauds if rate not in ALL_BAUD_RATES]
    if unknown_rates:
        raise ConfigError(
            f"--baud is {unknown_rates[0]}, must be one of {', '.join(str(rate) for rate in ALL_BAUD_RATES)}"
        )
    rates = sorted(bauds or ALL_BAUD_RATES, key=lambda rate: (rate not in COMMON_BAUD_RATES, rate))
    found_servos: list[tuple[Path, FoundServo]] = []
    notes: list[str] = []
    with show_steps("scanning", len(paths) * len(rates)) as step:
        for path in paths:
            for found_servo in _scan_port(path, rates, thorough, notes, step):
                found_servos.append((path, found_servo))
    if as_json:
        click.echo(json.dumps([_to_json(path, found_servo) for path, found_servo in found_servos], indent=1))
    else:
        console().print(_tabulate(found_servos, hinges))
        click.echo(f"{len(found_servos)} servos")
    for note in notes:
        click.echo(note, err=True)
    return 0


def _scan_port(
    path: Path, rates: Sequence[int], thorough: bool, notes: list[str], step: Callable[[], None]
) -> Iterator[FoundServo]:
    """Yield the servos that answer on one port.

    A baud rate that the port does not support is noted; a port that never opens is an error.
    """
    is_first, heard, count = True, dict[int, int](), 0
    for rate in rates:
        try:
            ids = range(MAX_ID + 1) if thorough else ()
            for found_servo in scan_bus(lambda baud: SerialWire(path, baud), bauds=(rate,), ids=ids, heard=heard):
                count += 1
                yield found_servo
        except BusError as error:
            if is_first:
                raise
            notes.append(str(error))
        is_first = False
        step()
    if not count:
        notes.append(f"{path}: {_explain_silence(heard)}")


def _explain_silence(heard: Mapping[int, int]) -> str:
    """Explain from received bytes by baud rate why no servo answered."""
    rates = ", ".join(str(rate) for rate, octets in heard.items() if octets)
    if rates:
        return f"bytes came back at {rates} baud, but no packet of a known protocol; noise, or another kind of device?"
    return "no byte came back at any baud rate; is the power on, is the data line connected, does the adapter transmit?"


def _tabulate(found_servos: Sequence[tuple[Path, FoundServo]], hinges: dict[int, str]) -> Table:
    table = Table("port", "baud", "id", "model", "firmware", "protocol", "hinge", "")
    for path, found_servo in found_servos:
        servo = found_servo.servo
        note = quote_text("several servos have this id" if found_servo.shared else "", style="red")
        version = str(servo.firmware)
        hinge = hinges.get(servo.id, "-")
        cells = (str(found_servo.baud), str(servo.id), servo.name, version, found_servo.protocol, hinge)
        table.add_row(quote_text(path.name), *cells, note)
    return table


def _to_json(path: Path, found_servo: FoundServo) -> dict[str, object]:
    servo = found_servo.servo
    return {
        "port": str(path),
        "baud": found_servo.baud,
        "id": servo.id,
        "model": servo.name,
        "firmware": servo.firmware,
        "shared": found_servo.shared,
        "protocol": found_servo.protocol,
    }
