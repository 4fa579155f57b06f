"""Version of the package, read from its metadata.

It is defined in `pyproject.toml` only.
"""

from importlib.metadata import PackageNotFoundError, version


def _installed() -> str:
    """Return the installed version, or "not installed" in a bare source tree."""
    try:
        return version("kinesic")
    except PackageNotFoundError:
        return "not installed"


__version__ = _installed()
