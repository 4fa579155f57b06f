"""`kinesic doctor` and `kinesic servos doctor`: what works here, and the line that mends what does not."""

import platform

import click
from rich.table import Table

from kinesic import ik
from kinesic.cli.servos.ports import read_ports
from kinesic.cli.terminal import console
from kinesic.face import display
from kinesic.files.film_file import NO_ENCODER, find_encoder
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.diagnosis import Finding, diagnose
from kinesic.motion import spline_program
from kinesic.sim import gl
from kinesic.speech import espeak_pool, loudspeaker
from kinesic.version import __version__

CHECK_FAILED = 1


def examine_machine() -> int:
    """Shows what works here and what would mend the rest."""
    table = Table("piece", "state", box=None)
    table.add_row("kinesic", f"{__version__}, Python {platform.python_version()}, {platform.machine()}")
    table.add_row("ik kernel", ik.KERNEL)
    table.add_row("motion kernel", spline_program.KERNEL)
    table.add_row("film (MuJoCo, OpenGL)", gl.opengl_fault() or "works")
    table.add_row("film as mp4 (ffmpeg)", find_encoder() or NO_ENCODER)
    table.add_row("face (EGL, OpenGL)", display.available() or "works")
    table.add_row("speech (espeak-ng)", espeak_pool.espeak_fault() or "works")
    table.add_row("loudspeaker (PortAudio)", loudspeaker.audio_fault() or "works")
    console().print(table)
    return 0


def examine_servos(robot: str, ports: tuple[str, ...]) -> int:
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
