"""Reference page of the public Python names of kinesic and its subpackages."""

import inspect
from collections.abc import Iterator
from importlib import import_module
from math import inf

from kinesic.session.options import OPTION_CHOICES, list_cli_options

ROOMS = ("kinesic", "kinesic.ik", "kinesic.motion", "kinesic.client")
TITLES = {
    "kinesic": "Plan and perform",
    "kinesic.ik": "Inverse kinematics",
    "kinesic.motion": "Motion under limits",
    "kinesic.client": "Client of the server",
}
HEAD = """# Python

This page lists the public names of `kinesic`, `kinesic.ik`, `kinesic.motion` and `kinesic.client`.
[Use kinesic from Python](../how-to/use-from-python.md) shows the first steps.

- **Units**: angles are in radians, lengths in metres and times in seconds, unless a docstring says otherwise.
- **Arguments** after the obvious ones are keywords.
- **Errors** about documents are `kinesic.BmlError`, errors about files and options are `kinesic.ConfigError`, and
  errors about servos are `kinesic.BusError`.

"""


def list_names(room: str) -> list[str]:
    """Return the public names of a package."""
    module = import_module(room)
    names = list(getattr(module, "__all__", [])) or [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", "") == room
    ]
    return [name for name in names if name != "__version__"]


def place_of(room: str, name: str) -> str:
    """Return the dotted path at which a public name is defined."""
    value = getattr(import_module(room), name)
    return f"{value.__module__}.{value.__qualname__}"


def write_page() -> str:
    """Return the page with one mkdocstrings directive per public name."""
    lines = [HEAD + "| name | use |", "|---|---|"]
    shown: set[str] = set()
    sections: list[str] = []
    for room in ROOMS:
        sections += ["", f"## {TITLES[room]}"]
        for name in list_names(room):
            place = place_of(room, name)
            first = (inspect.getdoc(getattr(import_module(room), name)) or "").splitlines()[0]
            lines.append(f"| [`{room}.{name}`](#{place}) | {first} |")
            if place not in shown:
                sections += ["", f"::: {place}"]
            shown.add(place)
    lines.append("| `kinesic.__version__` | The installed version, as a text. |")
    return "\n".join([*lines, *sections, "", *describe_options()]) + "\n"


def describe_options() -> Iterator[str]:
    """Yield the section on keyword options of `Performer`, `perform` and `plan`."""
    yield "## Planning options\n\n`Performer`, `perform` and `plan` take these keywords besides robot and style.\n"
    yield "| keyword | effect | value |\n|---|---|---|"
    for name, option in list_cli_options().items():
        limit = f"0 to {option.most:g}" if option.most < inf else ""
        choices = ", ".join(f"`{choice}`" for choice in OPTION_CHOICES.get(name, ())) or limit
        yield f"| `{name}` | {option.help.replace('|', '&#124;')} | {choices} |"
