"""The version of the package, as its metadata has it: `pyproject.toml` alone says what it is."""

from importlib.metadata import PackageNotFoundError, version


def _installed() -> str:
    """The version that is installed; a source tree that nobody has installed has none."""
    try:
        return version("kinesic")
    except PackageNotFoundError:
        return "not installed"


__version__ = _installed()
