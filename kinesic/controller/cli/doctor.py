"""`kinesic doctor`: what works on this machine, and the one line that mends what does not."""

import importlib.util
import platform

import click
from rich.console import Console
from rich.table import Table

from kinesic import __version__
from kinesic.face import display
from kinesic.ik import KERNEL
from kinesic.sim import gl

PIECES = {
    "speech (espeak-ng)": ("espeakng_loader", "pip install 'kinesic[speech]'"),
    "studio (viser)": ("viser", "pip install 'kinesic[studio]'"),
}


@click.command()
def doctor() -> int:
    """Shows what works here and what would mend the rest."""
    table = Table("piece", "state", "what mends it", box=None)
    table.add_row("kinesic", f"{__version__}, Python {platform.python_version()}, {platform.machine()}", "")
    table.add_row("ik kernel", KERNEL, "")
    fault = gl.fault()
    table.add_row("film (MuJoCo, OpenGL)", "works" if fault is None else fault, "" if fault is None else gl.APT_LINE)
    reason = display.available()
    table.add_row("face (moderngl, EGL)", "works" if reason is None else reason, "")
    for name, (module, line) in PIECES.items():
        present = importlib.util.find_spec(module) is not None
        table.add_row(name, "installed" if present else "not installed", "" if present else line)
    Console().print(table)
    return 0
