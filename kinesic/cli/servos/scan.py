"""`kinesic servos scan`: who is on a port, at which id and baud rate."""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import click
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from kinesic.body.config import ConfigError
from kinesic.cli.terminal import console, quote_text
from kinesic.hardware.bus.host import ports as ports_here
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.registers import BAUD_RATES
from kinesic.hardware.protocol.servo_map import MAX_ID, ServoMap, load_robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.tools.survey import Sighting, scan_bus

LIKELY = (57_600, 1_000_000)  # factory rate, and what most robots use: they are tried first


def scan_ports(robot: str, ports: tuple[str, ...], bauds: tuple[int, ...], thorough: bool, as_json: bool) -> int:
    """Prints the servos that answer at any of the baud rates; nothing is changed."""
    hinges = {servo: row.hinge for row in ServoMap.of(load_robot(robot)).servos for servo in row.ids}
    paths = [Path(text.partition("=")[2] or text) for text in ports] or list(ports_here())
    if not paths:
        raise ConfigError("no USB serial port here; plug the adapter in, or give --port PATH")
    unknown = [rate for rate in bauds if rate not in BAUD_RATES]
    if unknown:
        raise ConfigError(f"--baud is {unknown[0]}, must be one of {', '.join(str(rate) for rate in BAUD_RATES)}")
    rates = sorted(bauds or BAUD_RATES, key=lambda rate: (rate not in LIKELY, rate))
    found: list[tuple[Path, Sighting]] = []
    notes: list[str] = []
    with Progress(console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task("scanning", total=len(paths) * len(rates))
        for path in paths:
            for sighting in _scanned(path, rates, thorough, notes, lambda: progress.advance(task)):
                found.append((path, sighting))
    if as_json:
        click.echo(json.dumps([_plain(path, sighting) for path, sighting in found], indent=1))
    else:
        console().print(_table(found, hinges))
        click.echo(f"{len(found)} servos")
    for note in notes:
        click.echo(note, err=True)
    return 0


def _scanned(
    path: Path, rates: Sequence[int], thorough: bool, notes: list[str], step: Callable[[], None]
) -> Iterator[Sighting]:
    """Yields the servos of a port. A rate that it does not do is noted; a port that never opens is an error."""
    first = True
    for rate in rates:
        try:
            yield from scan_bus(
                lambda baud: SerialWire(path, baud), bauds=(rate,), ids=range(MAX_ID + 1) if thorough else ()
            )
        except BusError as error:
            if first:
                raise
            notes.append(str(error))
        first = False
        step()


def _table(found: Sequence[tuple[Path, Sighting]], hinges: dict[int, str]) -> Table:
    table = Table("port", "baud", "id", "model", "firmware", "hinge", "", box=None, header_style="bold")
    for path, sighting in found:
        servo = sighting.servo
        note = "[red]several servos have this id[/]" if sighting.shared else ""
        cells = (str(sighting.baud), str(servo.id), servo.name, str(servo.firmware), hinges.get(servo.id, "-"))
        table.add_row(quote_text(path.name), *cells, note)
    return table


def _plain(path: Path, sighting: Sighting) -> dict[str, object]:
    servo = sighting.servo
    return {
        "port": str(path),
        "baud": sighting.baud,
        "id": servo.id,
        "model": servo.name,
        "firmware": servo.firmware,
        "shared": sighting.shared,
    }
