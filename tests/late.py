"""Modules that few tests need and that take long to import: every process of a run reads all files of tests."""

from importlib import import_module


class LateModule:
    """A module that is imported when something of it is first asked for."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, asked: str):
        if asked.startswith("_"):  # pytest asks such things of all that it finds in a file
            raise AttributeError(asked)
        return getattr(import_module(self._name), asked)
