"""Verbs `kinesic doctor` and `kinesic servos doctor`: detect faults and print remedies."""

import platform
from collections.abc import Callable, Mapping

import click

from kinesic.body.robot import Robot
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.servos.ports import read_ports
from kinesic.cli.terminal import console, quote_text
from kinesic.face import display
from kinesic.files.film_file import explain_missing_encoder, find_encoder
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.wiring_check import find_supply_faults
from kinesic.hardware.tools.diagnosis import ServoFinding, diagnose
from kinesic.sim import gl
from kinesic.speech import espeak_pool, loudspeaker
from kinesic.speech.hibari.engine import hibari_fault
from kinesic.version import __version__

COMPONENT_CHECKS: Mapping[str, Callable[[], str | None]] = {  # component -> check that returns its problem, if any
    "film (MuJoCo, OpenGL)": gl.opengl_fault,
    "film as mp4 (ffmpeg)": lambda: find_encoder() or explain_missing_encoder(),
    "face (EGL, OpenGL)": display.find_display_problem,
    "voice (hibari)": hibari_fault,
    "speech (espeak-ng)": espeak_pool.espeak_fault,
    "loudspeaker (PortAudio)": loudspeaker.audio_fault,
}
CHECK_FAILED_EXIT_CODE = 1  # exit code if `kinesic servos doctor` finds a fault


def examine_machine() -> int:
    """Print whether each optional component works, or how to install it."""
    table = Table("component", "state")
    table.add_row("kinesic", f"{__version__}, Python {platform.python_version()}, {platform.machine()}")
    with show_stages() as stage:
        for component, examine in COMPONENT_CHECKS.items():
            stage(f"trying {component}")
            table.add_row(component, quote_text(examine() or "works"))
    console().print(table)
    return 0


def examine_servos(robot: str, ports: tuple[str, ...]) -> int:
    """Check ports, permissions, latency, supply and servos, and print remedies."""
    fault_count = count_servo_faults(load_robot(robot), ports)
    click.echo(f"{fault_count} to fix" if fault_count else "no problems")
    return CHECK_FAILED_EXIT_CODE if fault_count else 0


def count_servo_faults(robot: Robot, ports: tuple[str, ...]) -> int:
    """Diagnose a robot's servos, print the findings, and return the fault count."""
    manifest = Manifest.of(robot)
    paths = read_ports(ports, manifest.bauds)
    fault_count = 0
    for line in find_supply_faults(robot):
        fault_count += 1
        _print_finding(ServoFinding("-", "supply", False, line))
    for finding in diagnose(manifest, paths, lambda bus: SerialWire(paths[bus], manifest.bauds[bus])):
        fault_count += not finding.well
        _print_finding(finding)
    return fault_count


def _print_finding(finding: ServoFinding) -> None:
    mark = click.style("ok  ", fg="green") if finding.well else click.style("fix ", fg="red")
    first, *rest = finding.text.splitlines()
    click.echo(f"{mark}  {finding.bus:8} {finding.about:8} {first}")
    for line in rest:
        click.echo(f"{'':24}{line}")
