"""Verb `kinesic servos show`: print the state of every servo."""

import json
from dataclasses import asdict
from math import isnan

import click

from kinesic.cli.screen.table import Table
from kinesic.cli.servos.ports import open_ports, read_ports
from kinesic.cli.terminal import console, quote_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.survey import SurveyedServo, survey

FAULT_EXIT_CODE = 3  # exit code if a servo is missing, of another model, or reports an error


def show_servos(robot: str, ports: tuple[str, ...], as_json: bool) -> int:
    """Print each servo's state and its differences from the robot file.

    Nothing is changed.
    """
    manifest = Manifest.of(load_robot(robot))
    with open_ports(manifest, read_ports(ports, manifest.bauds)) as wires:
        servos = survey(manifest, wires)
    if as_json:
        click.echo(json.dumps([_to_json(servo) for servo in servos], indent=1))
    else:
        console().print(_tabulate(servos))
    return FAULT_EXIT_CODE if any(servo.errors or not servo.right for servo in servos) else 0


def _tabulate(servos: tuple[SurveyedServo, ...]) -> Table:
    names = ("hinge", "id", "model", "firmware", "deg", "C", "V", "torque", "errors", "differs from the robot's file")
    table = Table(*names)
    for servo in servos:
        labels = (servo.member.hinge, str(servo.member.id))
        if not servo.model_name:
            table.add_row(*labels, quote_text("does not answer", style="red"))
        elif not servo.right:
            model = quote_text(f"{servo.model_name}, must be {servo.member.model.name}", style="red")
            table.add_row(*labels, model, str(servo.firmware))
        else:
            state = (f"{servo.degrees:.1f}", str(servo.celsius), f"{servo.volts:.1f}", "on" if servo.torque else "off")
            errors = quote_text(", ".join(servo.errors), style="red")
            table.add_row(*labels, servo.model_name, str(servo.firmware), *state, errors, _format_differences(servo))
    return table


def _format_differences(servo: SurveyedServo) -> str:
    return ", ".join(f"{change.register.name} {change.before} (-> {change.after})" for change in servo.differs)


def _to_json(servo: SurveyedServo) -> dict[str, object]:
    return {
        "bus": servo.member.bus,
        "id": servo.member.id,
        "hinge": servo.member.hinge,
        "model": servo.model_name or None,
        "wanted_model": servo.member.model.name,
        "firmware": servo.firmware,
        "deg": None if isnan(servo.degrees) else servo.degrees,
        "celsius": servo.celsius,
        "volts": servo.volts,
        "torque": servo.torque,
        "errors": list(servo.errors),
        "differs": [asdict(change) | {"register": change.register.name} for change in servo.differs],
    }
