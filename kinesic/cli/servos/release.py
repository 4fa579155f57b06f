"""`kinesic servos release`: lets go of every servo, and makes sure of it."""

from contextlib import ExitStack

import click

from kinesic.cli.servos.ports import all_ports, robot_and_ports
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.release import release_servos as release_all

FAULT = 3


@click.command()
@robot_and_ports
@click.option("--yes", is_flag=True, help="Does not ask whether somebody holds the robot.")
def release(robot: str, ports: tuple[str, ...], yes: bool) -> int:
    """Takes the torque of every servo, and looks that it is gone. The robot goes limp: hold its arms."""
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
        doubts += release_all(wires, {name: [m.id for m in manifest.members if m.bus == name] for name in wires})
    for line in doubts:
        click.echo(f"kinesic: {line}", err=True)
    if not doubts:
        click.echo(f"all {len(manifest.members)} servos are limp")
    return FAULT if doubts else 0
