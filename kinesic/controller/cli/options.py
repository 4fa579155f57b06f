"""Options that several verbs share."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Literal, get_args

import click

from kinesic.bml.block import Dialect
from kinesic.controller.facts import Facts
from kinesic.controller.perform import facts
from kinesic.controller.robots import load_robot
from kinesic.controller.targets import read_targets
from kinesic.expressivity.style import Style

DIALECTS = ["auto", *get_args(Dialect)]


@dataclass(frozen=True)
class Settings:
    """What the shared options say; picklable, so that other processes can make the same facts."""

    robot: str
    style: str
    changes: tuple[str, ...]
    lexicon: Path | None
    targets: Path | None
    dialect: Dialect | Literal["auto"]

    def facts(self) -> Facts:
        """Reads everything that the options name.

        Raises:
            ConfigError: something is missing or wrong.
        """
        return facts(
            load_robot(self.robot),
            style=Style.load(self.style).changed(self.changes),
            lexicon=self.lexicon,
            targets=read_targets(self.targets) if self.targets else None,
            dialect=self.dialect,
        )


def planning(verb: Callable[..., int]) -> Callable[..., int]:
    """Adds the options that say how a document is planned, and hands them on as `settings`."""

    @wraps(verb)
    def with_settings(
        *,
        robot: str,
        style: str,
        changes: tuple[str, ...],
        lexicon: Path | None,
        targets: Path | None,
        dialect: Dialect | Literal["auto"],
        **own: object,
    ) -> int:
        return verb(settings=Settings(robot, style, changes, lexicon, targets, dialect), **own)

    options = (
        click.option("--robot", default="upper22", show_default=True, help="Name, or a robot's TOML file."),
        click.option("--style", default="neutral", show_default=True, help="Preset of expressivity."),
        click.option("--set", "changes", multiple=True, metavar="NAME=VALUE", help="Changes a style, e.g. power=0.8."),
        click.option("--lexicon", type=click.Path(path_type=Path), help="Gestures: TOML, or Greta's gestuary XML."),
        click.option("--dialect", type=click.Choice(DIALECTS), default="auto", help="How documents are read."),
        click.option("--targets", type=click.Path(path_type=Path), help="TOML of named points in the world [m]."),
    )
    decorated: Callable[..., int] = with_settings
    for option in reversed(options):
        decorated = option(decorated)
    return decorated
