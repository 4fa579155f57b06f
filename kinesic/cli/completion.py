"""Shell completion of names: styles, robots, gestures and documents."""

from collections.abc import Callable, Iterable
from pathlib import Path

import click
from click.shell_completion import CompletionItem

from kinesic.body.config import names_of
from kinesic.importing import import_at_once
from kinesic.session.builtin_documents import builtin_documents

SHELL_NAMES = ("bash", "zsh", "fish")


class NameOrFile(click.ParamType[str]):
    """Parameter type for a built-in name or a file, with shell completion."""

    name = "text"

    def __init__(self, list_names: Callable[[], Iterable[str]], *, has_files: bool = True) -> None:
        """Create the parameter type for a list of names.

        Args:
            list_names: returns the names, called when a shell completes one.
            has_files: whether a file may be given instead.
        """
        self._list_names, self._has_files = list_names, has_files

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Return completions: the names that begin with a text, and files."""
        return complete_names(self._list_names(), incomplete, has_files=self._has_files)


class DocumentPath(click.Path):
    """Path that may also be the name of a built-in document."""

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Return completions: built-in documents that begin with a text, and files."""
        return complete_names(builtin_documents(), incomplete)


def complete_names(names: Iterable[str], incomplete: str, *, has_files: bool = True) -> list[CompletionItem]:
    """Convert the names that begin with a text to completions, plus files."""
    files = [CompletionItem(incomplete, type="file")] if has_files else []  # first: bash drops what precedes it
    return [*files, *(CompletionItem(name) for name in names if name.startswith(incomplete))]


def list_gesture_names() -> tuple[str, ...]:
    """Return the names of the built-in gestures."""
    lexicon = import_at_once("kinesic.expressivity.lexicon.lexicon").Lexicon.load()
    return tuple(sorted({entry.id for entry in lexicon.entries}))


STYLE_NAME = NameOrFile(lambda: names_of("style"))
ROBOT_NAME = NameOrFile(lambda: names_of("robot"))
DOCUMENT_NAME = NameOrFile(builtin_documents)
GESTURE_NAME = NameOrFile(list_gesture_names, has_files=False)
DOCUMENT_PATH = DocumentPath(path_type=Path)
