"""Reads files of answers: CSV with a first line of names, of which nothing is believed before it is checked."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from kinesic.body.config import ConfigError, suggestion

MOST_NAMED = 30  # columns that an error names


def read_rows(paths: Sequence[Path], needed: Sequence[str]) -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yields all rows of files by their columns, each with where it stands.

    Args:
        paths: of the files.
        needed: columns that each must have.

    Raises:
        ConfigError: a file or a column is missing, or a row has another length than the first line.
    """
    for path in paths:
        with _opened(path) as lines:
            rows = csv.DictReader(lines)
            names = list(rows.fieldnames or ())
            missing = [name for name in needed if name not in names]
            if missing:
                near, some = suggestion(missing[0], names), ", ".join(names[:MOST_NAMED])
                raise ConfigError(f"{path}: no column {missing[0]}{near}; it has {some}")
            for row in rows:
                where = f"{path}:{rows.line_num}"
                if None in row or None in row.values():
                    raise ConfigError(f"{where}: must have {len(names)} values, like the first line")
                yield where, row


def read_columns(path: Path) -> tuple[str, ...]:
    """Reads the names of the columns of a file.

    Raises:
        ConfigError: it is missing, or no CSV.
    """
    with _opened(path) as lines:
        return tuple(csv.DictReader(lines).fieldnames or ())


@contextmanager
def _opened(path: Path) -> Iterator[TextIO]:
    """Opens a file of CSV; what is wrong with it is told in one line."""
    try:
        with path.open(newline="", encoding="utf-8") as lines:
            yield lines
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigError(f"{path} is not text in UTF-8") from None
    except csv.Error as error:
        raise ConfigError(f"{path} is no CSV: {error}") from None
