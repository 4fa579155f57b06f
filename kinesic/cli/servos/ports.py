"""The ports of a robot's buses: read from options, and opened."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from kinesic.body.config import ConfigError, suggestion
from kinesic.hardware.bus.host import ports as ports_here
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.supervisor.manifest import Manifest


def read_ports(given: Iterable[str], buses: Iterable[str]) -> dict[str, Path]:
    """Reads the port of each bus that is named.

    Args:
        given: NAME=PATH, or PATH if there is one bus.
        buses: of the robot.

    Raises:
        ConfigError: a bus is unknown or named twice, or no port is given.
    """
    known, found = list(buses), dict[str, Path]()
    for text in given:
        name, sign, path = text.partition("=")
        if not sign and len(known) == 1:
            name, path = known[0], text
        if name not in known:
            raise ConfigError(f"--port {text}: no bus {name}{suggestion(name, known)}; give NAME=PATH")
        if name in found or not path:
            raise ConfigError(f"--port {text}: give one path for bus {name}")
        found[name] = Path(path)
    if not found:
        here = ", ".join(str(path) for path in ports_here()) or "none that USB knows of"
        wanted = " ".join(f"--port {name}=PATH" for name in known)
        raise ConfigError(f"no port given; add {wanted}; serial ports here: {here}")
    return found


def all_ports(given: Iterable[str], buses: Iterable[str]) -> dict[str, Path]:
    """Reads the ports of all buses.

    Raises:
        ConfigError: one has none.
    """
    known = list(buses)
    found = read_ports(given, known)
    missing = " ".join(f"--port {name}=PATH" for name in known if name not in found)
    if missing:
        raise ConfigError(f"a bus has no port; add {missing}")
    return found


@contextmanager
def open_ports(manifest: Manifest, ports: Mapping[str, Path]) -> Iterator[dict[str, Wire]]:
    """Opens wires at the baud rates of the robot's buses, and closes them at the end.

    Raises:
        BusError: a port does not open.
    """
    with ExitStack() as closing:
        wires: dict[str, Wire] = {}
        for name, path in ports.items():
            wires[name] = wire = SerialWire(path, manifest.bauds[name])
            closing.callback(wire.close)
        yield wires
