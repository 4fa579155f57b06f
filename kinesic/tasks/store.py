"""Results of many tasks as Parquet: tables that are made of what a run has written, and asked in SQL."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kinesic.body.config import ConfigError
from kinesic.files.output_file import new_file

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

JOURNAL = "finished.jsonl"  # of documents that were performed
SWEEP, FIGURES, DESIGNS = "sweep.json", "bench.json", "designs.json"  # what other runs leave

ENTRY = (
    "STRUCT(file VARCHAR, outcome VARCHAR, exit INTEGER, error VARCHAR, report VARCHAR, behaviours VARCHAR[][], "
    'checks STRUCT(name VARCHAR, status VARCHAR, "value" DOUBLE, "limit" DOUBLE, unit VARCHAR, "where" VARCHAR)[])'
)
COLUMNS = f"{{'key': 'VARCHAR', 'entry': '{ENTRY}'}}"
READ = f"read_json(?, format='newline_delimited', columns={COLUMNS}, ignore_errors=true)"
LINES = f"(SELECT * FROM {READ} WHERE entry.file IS NOT NULL)"  # a line that is not whole is a row of nothing
WHOLE = "read_json(?, maximum_object_size=1000000000)"
TABLES: Mapping[str, Mapping[str, str]] = {
    JOURNAL: {
        "documents": f"SELECT key, entry.file, entry.outcome, entry.exit, entry.error, entry.report FROM {LINES}",
        "behaviours": f"SELECT file, b[1] AS type, b[2] AS outcome FROM "
        f"(SELECT entry.file AS file, unnest(entry.behaviours) AS b FROM {LINES})",
        "checks": f"SELECT file, c.* FROM (SELECT entry.file AS file, unnest(entry.checks) AS c FROM {LINES})",
    },
    SWEEP: {
        "sweep": "SELECT gesture, style, parameter, measure, p.* FROM (SELECT gesture, style, s.parameter, s.measure, "
        f"unnest(s.played) AS p FROM (SELECT gesture, style, unnest(series) AS s FROM {WHOLE}))"
    },
    FIGURES: {"figures": "SELECT * FROM read_json(?)"},
    DESIGNS: {"designs": f"SELECT d.* EXCLUDE (performed, changes) FROM (SELECT unnest(designs) AS d FROM {WHOLE})"},
}


@dataclass(frozen=True)
class QueryResult:
    """What a query found."""

    columns: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]


@dataclass(frozen=True, eq=False)
class Store:
    """The results of a folder."""

    connection: "DuckDBPyConnection"
    tables: tuple[str, ...]

    def ask(self, query: str) -> QueryResult:
        """Asks in SQL.

        Raises:
            ConfigError: the query is wrong.
        """
        import duckdb  # noqa: PLC0415 - an extra, which is there: the store is open

        try:
            found = self.connection.execute(query)
            return QueryResult(tuple(column[0] for column in found.description or ()), tuple(found.fetchall()))
        except duckdb.Error as error:
            names = ", ".join(self.tables)
            raise ConfigError(f"the query is wrong: {str(error).splitlines()[0]}; tables are {names}") from None


@contextmanager
def open_store(folder: Path) -> Iterator[Store]:
    """Opens the results of a folder; tables that are older than what they are made of are written anew.

    Args:
        folder: of a run; each NAME.parquet in it is a table NAME.

    Raises:
        ConfigError: duckdb is not installed, or there are no results.
    """
    try:
        import duckdb  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise ConfigError("results need duckdb: pip install 'kinesic[store]'") from None
    with duckdb.connect() as connection:
        connection.execute("SET enable_progress_bar_print = false")  # it would go where rows go
        for source, tables in TABLES.items():
            if (folder / source).exists():
                for name, select in tables.items():
                    _refresh(connection, folder / f"{name}.parquet", folder / source, select)
        paths = sorted(folder.glob("*.parquet"))
        if not paths:
            raise ConfigError(f"{folder}: no results; `kinesic validate DOCUMENTS --out {folder}` makes some")
        for path in paths:
            view = path.stem.replace('"', '""')
            connection.execute(f"CREATE VIEW \"{view}\" AS SELECT * FROM read_parquet('{_quoted(path)}')")
        yield Store(connection, tuple(path.stem for path in paths))


def _refresh(connection: "DuckDBPyConnection", path: Path, source: Path, select: str) -> None:
    """Writes a table, unless it is younger than what it is made of."""
    if path.exists() and path.stat().st_mtime_ns > source.stat().st_mtime_ns:
        return
    with new_file(path, force=True) as fresh:
        text = select.replace("?", f"'{_quoted(source)}'")
        connection.execute(f"COPY ({text}) TO '{_quoted(fresh)}' (FORMAT parquet, COMPRESSION zstd)")


def _quoted(path: Path) -> str:
    return str(path).replace("'", "''")
