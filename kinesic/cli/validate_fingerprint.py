"""What a verdict depends on beside its document: the options, the files that they name, and the program itself."""

import hashlib
from collections.abc import Iterator
from pathlib import Path

from kinesic.body.calibration import calibration_path
from kinesic.body.config import locate
from kinesic.cli.options import PlanningOptions

PACKAGE = Path(__file__).resolve().parents[1]
PARTS = (".py", ".toml", ".so", ".pyd")


def fingerprint(settings: PlanningOptions, *others: str) -> str:
    """A text that changes with anything that could change a verdict.

    Args:
        settings: of planning.
        others: further options that name a file, or nothing.
    """
    digest = hashlib.sha256(repr((settings, others)).encode())
    calibration = calibration_path(locate("robot", settings.robot))
    options = (settings.robot, calibration, settings.style, settings.lexicon, settings.targets, *others)
    for file in (*_program(), *_named(options)):
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def _program() -> Iterator[Path]:
    """The package's own code and facts."""
    return (file for file in sorted(PACKAGE.rglob("*")) if file.suffix in PARTS)


def _named(options: tuple[str | Path | None, ...]) -> Iterator[Path]:
    """Files that options name, and those in folders that they name."""
    for option in options:
        path = Path(option) if option else None
        if path and path.is_file():
            yield path
        elif path and path.is_dir():
            yield from (file for file in sorted(path.rglob("*")) if file.is_file())
