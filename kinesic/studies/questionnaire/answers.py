"""Reader of answer files: CSV with a header line, fully checked."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from kinesic.body.config import ConfigError, suggestion

MAX_NAMED_COLUMNS = 30  # largest number of columns named in an error


def read_rows(paths: Sequence[Path], needed: Sequence[str]) -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yield all rows of answer files as mappings, each with its location.

    Args:
        paths: paths of the files.
        needed: required columns.

    Raises:
        ConfigError: a file or column is missing, or a row differs in length from the first line.
    """
    for path in paths:
        with _open_csv(path) as lines:
            rows = csv.DictReader(lines)
            names = list(rows.fieldnames or ())
            missing = [name for name in needed if name not in names]
            if missing:
                hint, listed = suggestion(missing[0], names), ", ".join(names[:MAX_NAMED_COLUMNS])
                content = f"it has {listed}" if names else "the file is empty"
                raise ConfigError(f"{path}: no column {missing[0]}{hint}; {content}")
            for row in rows:
                location = f"{path}:{rows.line_num}"
                if None in row or None in row.values():
                    raise ConfigError(f"{location}: must have {len(names)} values, like the first line")
                yield location, row


def read_columns(path: Path) -> tuple[str, ...]:
    """Read the column names of an answer file.

    Raises:
        ConfigError: the file is missing or not CSV.
    """
    with _open_csv(path) as lines:
        return tuple(csv.DictReader(lines).fieldnames or ())


@contextmanager
def _open_csv(path: Path) -> Iterator[TextIO]:
    """Open a CSV file and convert its errors to one-line messages."""
    try:
        with path.open(newline="", encoding="utf-8") as lines:
            yield lines
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigError(f"{path} is not text in UTF-8") from None
    except csv.Error as error:
        raise ConfigError(f"{path} is not CSV: {error}") from None
