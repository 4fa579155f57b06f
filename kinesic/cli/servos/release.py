"""`kinesic servos release`: lets go of every servo, and makes sure of it."""

from contextlib import ExitStack

import click

from kinesic.cli.servos.ports import all_ports
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.release import release_servos

FAULT = 3


def release_robot(robot: str, ports: tuple[str, ...], yes: bool) -> int:
    """Takes the torque of every servo, and looks that it is gone."""
    manifest = Manifest.of(load_robot(robot))
    paths = all_ports(ports, manifest.bauds)
    if not yes:
        click.confirm("The robot will go limp. Is somebody holding it?", abort=True)
    wires: dict[str, Wire] = {}
    doubts: list[str] = []
    with ExitStack() as closing:
        for name, path in paths.items():
            try:
                wires[name] = SerialWire(path, manifest.bauds[name])
            except BusError as error:
                if len(paths) == 1:
                    raise
                doubts.append(f"{error}; the servos of bus {name} may still have torque")
                continue
            closing.callback(wires[name].close)
        doubts += release_servos(wires, {name: [m.id for m in manifest.members if m.bus == name] for name in wires})
    for line in doubts:
        click.echo(f"kinesic: {line}", err=True)
    if not doubts:
        click.echo(f"all {len(manifest.members)} servos are limp")
    return FAULT if doubts else 0
