"""Verb `kinesic new`: write a commented gesture, style or robot file."""

import re
from pathlib import Path
from typing import Literal

import click

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.files.output_file import write_text
from kinesic.files.plain_name import is_device_name

Kind = Literal["gesture", "style", "robot"]

VALID_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
EXAMPLE_ROBOT = "upper22"  # robot whose file serves as template
TRIAL_COMMANDS: dict[Kind, str] = {
    "gesture": "kinesic gestures render {name} --lexicon {file} --out {name}.png",
    "style": "kinesic sweep beat --parameter power --style {file}",
    "robot": "kinesic robots check {file}",
}


def write_new(kind: Kind, name: str, out: Path, force: bool) -> int:
    """Write a template file and print a command that tries it.

    Args:
        kind: kind of file.
        name: name of the gesture, style or robot.
        out: TOML file, or a folder for the file `NAME.toml`.
        force: whether to replace a file of this name.

    Raises:
        ConfigError: the name is not an identifier or reserved by Windows, or the file cannot be written.
    """
    if not VALID_NAME.fullmatch(name):
        raise ConfigError(f"{name!r}: a name has 1 to 64 letters, digits and underscores and begins with a letter")
    if is_device_name(name):
        raise ConfigError(f"{name!r}: Windows reserves this name for a device; choose another one")
    file = out if out.suffix == ".toml" and not out.is_dir() else out / f"{name}.toml"
    write_text(file, starting_text(kind, name), force=force)
    click.echo(f"{kind}: {file}")
    click.echo("try: " + TRIAL_COMMANDS[kind].format(name=name, file=file))
    return 0


def starting_text(kind: Kind, name: str) -> str:
    """Return a commented template file for a gesture, style or robot."""
    if kind == "robot":
        example = (CONFIGS / "robots" / f"{EXAMPLE_ROBOT}.toml").read_text(encoding="utf-8")
        heading = (
            f"# {name}: a copy of {EXAMPLE_ROBOT}; change bodies, hinges, servos and ids to those of your robot.\n"
            "# Guide: docs/how-to/build-a-robot.md. `kinesic robots check FILE` reports mistakes.\n#\n"
        )
        return heading + example.replace(f'name = "{EXAMPLE_ROBOT}"', f'name = "{name}"', 1)
    return (CONFIGS / "templates" / f"{kind}.toml").read_text(encoding="utf-8").replace("NAME", name)
