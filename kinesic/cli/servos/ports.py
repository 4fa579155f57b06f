"""Serial ports of a robot's buses: parse options and open wires."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from kinesic.body.config import ConfigError, suggestion
from kinesic.hardware.bus.host import list_ports as ports_here
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.supervisor.manifest import Manifest


def read_ports(texts: Iterable[str], buses: Iterable[str]) -> dict[str, Path]:
    """Parse the port given for each servo bus.

    Args:
        texts: NAME=PATH, or PATH alone if there is only one bus.
        buses: names of the robot's buses.

    Raises:
        ConfigError: a bus is unknown or named twice, or no port is given.
    """
    bus_names = list(buses)
    ports = read_bus_paths(texts, bus_names, option="--port")
    if not ports:
        here = ", ".join(str(path) for path in ports_here()) or "none on USB"
        remedy = " ".join(f"--port {name}=PATH" for name in bus_names)
        raise ConfigError(f"no port given; add {remedy}; serial ports here: {here}")
    return ports


def read_bus_paths(texts: Iterable[str], buses: Iterable[str], *, option: str) -> dict[str, Path]:
    """Parse the path given for each servo bus.

    A text is NAME=PATH, or PATH alone if there is only one bus.

    Raises:
        ConfigError: a bus is unknown or named twice.
    """
    bus_names, paths = list(buses), dict[str, Path]()
    for text in texts:
        name, separator, path = text.partition("=")
        if not separator and len(bus_names) == 1:
            name, path = bus_names[0], text
        if name not in bus_names:
            raise ConfigError(f"{option} {text}: no bus {name}{suggestion(name, bus_names)}; give NAME=PATH")
        if name in paths or not path:
            raise ConfigError(f"{option} {text}: give one path for bus {name}")
        paths[name] = Path(path)
    return paths


def read_all_ports(texts: Iterable[str], buses: Iterable[str]) -> dict[str, Path]:
    """Parse the servo ports, and require a port for every bus.

    Raises:
        ConfigError: a bus has no port.
    """
    bus_names = list(buses)
    ports = read_ports(texts, bus_names)
    missing = " ".join(f"--port {name}=PATH" for name in bus_names if name not in ports)
    if missing:
        raise ConfigError(f"a bus has no port; add {missing}")
    return ports


@contextmanager
def open_ports(manifest: Manifest, ports: Mapping[str, Path]) -> Iterator[dict[str, Wire]]:
    """Open the servo buses at the robot's baud rates.

    Raises:
        BusError: a port does not open.
    """
    with ExitStack() as stack:
        wires: dict[str, Wire] = {}
        for name, path in ports.items():
            wires[name] = wire = SerialWire(path, manifest.bauds[name])
            stack.callback(wire.close)
        yield wires
