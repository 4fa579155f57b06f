"""`kinesic servos doctor`: what keeps the servos from being driven, and the line that mends it."""

import click

from kinesic.cli.servos.ports import read_ports, robot_and_ports
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.diagnosis import Finding, diagnose

CHECK_FAILED = 1


@click.command()
@robot_and_ports
def doctor(robot: str, ports: tuple[str, ...]) -> int:
    """Checks ports, permissions, latency, supply and every servo; prints the line that mends what is wrong."""
    manifest = Manifest.of(load_robot(robot))
    paths = read_ports(ports, manifest.bauds)
    wrong = 0
    for finding in diagnose(manifest, paths, lambda bus: SerialWire(paths[bus], manifest.bauds[bus])):
        wrong += not finding.well
        _print(finding)
    click.echo(f"{wrong} to mend" if wrong else "all well")
    return CHECK_FAILED if wrong else 0


def _print(finding: Finding) -> None:
    mark = click.style("ok  ", fg="green") if finding.well else click.style("mend", fg="red")
    first, *rest = finding.text.splitlines()
    click.echo(f"{mark}  {finding.bus:8} {finding.about:8} {first}")
    for line in rest:
        click.echo(f"{'':24}{line}")
