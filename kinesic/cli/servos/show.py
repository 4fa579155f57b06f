"""`kinesic servos show`: how every servo of a robot is."""

import json
from dataclasses import asdict
from math import isnan

import click
from rich.table import Table

from kinesic.cli.servos.ports import open_ports, read_ports
from kinesic.cli.terminal import console
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.survey import SurveyedServo, survey

FAULT = 3


def show_servos(robot: str, ports: tuple[str, ...], as_json: bool) -> int:
    """Prints how every servo is and where it differs from the robot's file; nothing is changed."""
    manifest = Manifest.of(load_robot(robot))
    with open_ports(manifest, read_ports(ports, manifest.bauds)) as wires:
        found = survey(manifest, wires)
    if as_json:
        click.echo(json.dumps([_plain(seen) for seen in found], indent=1))
    else:
        console().print(_table(found))
    return FAULT if any(seen.errors or not seen.right for seen in found) else 0


def _table(found: tuple[SurveyedServo, ...]) -> Table:
    names = ("hinge", "id", "model", "firmware", "deg", "C", "V", "torque", "errors", "differs from the robot's file")
    table = Table(*names, box=None, header_style="bold")
    for seen in found:
        place = (seen.member.hinge, str(seen.member.id))
        if not seen.found:
            table.add_row(*place, "[red]does not answer[/]")
        elif not seen.right:
            table.add_row(*place, f"[red]{seen.found}, must be {seen.member.model.name}[/]", str(seen.firmware))
        else:
            state = (f"{seen.degrees:.1f}", str(seen.celsius), f"{seen.volts:.1f}", "on" if seen.torque else "off")
            errors = f"[red]{', '.join(seen.errors)}[/]" if seen.errors else ""
            table.add_row(*place, seen.found, str(seen.firmware), *state, errors, _differences(seen))
    return table


def _differences(seen: SurveyedServo) -> str:
    return ", ".join(f"{change.register.name} {change.before} (-> {change.after})" for change in seen.differs)


def _plain(seen: SurveyedServo) -> dict[str, object]:
    return {
        "bus": seen.member.bus,
        "id": seen.member.id,
        "hinge": seen.member.hinge,
        "model": seen.found or None,
        "wanted_model": seen.member.model.name,
        "firmware": seen.firmware,
        "deg": None if isnan(seen.degrees) else seen.degrees,
        "celsius": seen.celsius,
        "volts": seen.volts,
        "torque": seen.torque,
        "errors": list(seen.errors),
        "differs": [asdict(change) | {"register": change.register.name} for change in seen.differs],
    }
