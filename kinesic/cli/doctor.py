"""`kinesic doctor`: what works on this machine, and the line that mends what does not."""

import importlib.util
import platform

import click
from rich.table import Table

from kinesic.cli.terminal import console
from kinesic.face import display
from kinesic.ik import KERNEL
from kinesic.sim import gl
from kinesic.speech import espeak_pool, port_audio
from kinesic.version import __version__

EXTRAS = {"studio (viser)": ("viser", "studio")}


@click.command()
def doctor() -> int:
    """Shows what works here and what would mend the rest."""
    table = Table("piece", "state", box=None)
    table.add_row("kinesic", f"{__version__}, Python {platform.python_version()}, {platform.machine()}")
    table.add_row("ik kernel", KERNEL)
    table.add_row("film (MuJoCo, OpenGL)", gl.opengl_fault() or "works")
    table.add_row("face (moderngl, EGL)", display.available() or "works")
    table.add_row("speech (espeak-ng)", espeak_pool.espeak_fault() or "works")
    table.add_row("loudspeaker (PortAudio)", port_audio.audio_fault() or "works")
    for name, (module, extra) in EXTRAS.items():
        present = importlib.util.find_spec(module) is not None
        table.add_row(name, "installed" if present else f"not installed: pip install 'kinesic[{extra}]'")
    console().print(table)
    return 0
