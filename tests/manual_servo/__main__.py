"""Serve servos on a pseudo-terminal in a separate process.

Usage: `python -m manual_servo 1:xm430_w350 2:xc330_t288`.
"""

import os
import sys
import threading

from .device import Device
from .line import Line, World
from .pty import Port

BAUD_RATE = 1_000_000  # [bit/s] baud rate of servos and wire


def main(fittings: list[str]) -> None:
    """Create servos from ID:MODEL texts and serve them."""
    pairs = [fitting.split(":") for fitting in fittings]
    devices = [Device(int(servo), model, baud=BAUD_RATE) for servo, model in pairs]
    port = Port(Line(World(devices), devices, baud=BAUD_RATE))
    sys.stdout.write(port.path + "\n")
    sys.stdout.flush()
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    port.serve()


main(sys.argv[1:])
