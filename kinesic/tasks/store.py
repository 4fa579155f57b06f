"""Results of many tasks as Parquet tables with SQL queries."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra
from kinesic.files.output_file import new_file

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

JOURNAL_FILE = "finished.jsonl"  # name of the file with the journal of performed documents
SWEEP_FILE = "sweep.json"  # name of the file with the results of a parameter sweep
METRICS_FILE = "bench.json"  # name of the file with the results of a benchmark
DESIGNS_FILE = "designs.json"  # name of the file with the results of a design search

ENTRY_TYPE = (
    "STRUCT(file VARCHAR, outcome VARCHAR, exit INTEGER, error VARCHAR, report VARCHAR, behaviours VARCHAR[][], "
    'checks STRUCT(name VARCHAR, status VARCHAR, "value" DOUBLE, "limit" DOUBLE, unit VARCHAR, "where" VARCHAR)[])'
)
JOURNAL_COLUMNS = f"{{'key': 'VARCHAR', 'entry': '{ENTRY_TYPE}'}}"  # columns of a journal line
# SQL that reads a journal as a table, one row per line
READ_JOURNAL = f"read_json(?, format='newline_delimited', columns={JOURNAL_COLUMNS}, ignore_errors=true)"
VALID_LINES = f"(SELECT * FROM {READ_JOURNAL} WHERE entry.file IS NOT NULL)"  # broken lines are read as NULL
READ_JSON = "read_json(?, maximum_object_size=1000000000)"  # SQL that reads a JSON file
TABLE_QUERIES: Mapping[str, Mapping[str, str]] = {
    JOURNAL_FILE: {
        "documents": f"SELECT key, entry.file, entry.outcome, entry.exit, entry.error, entry.report FROM {VALID_LINES}",
        "behaviours": f"SELECT file, b[1] AS type, b[2] AS outcome FROM "
        f"(SELECT entry.file AS file, unnest(entry.behaviours) AS b FROM {VALID_LINES})",
        "checks": f"SELECT file, c.* FROM (SELECT entry.file AS file, unnest(entry.checks) AS c FROM {VALID_LINES})",
    },
    SWEEP_FILE: {
        "sweep": "SELECT gesture, style, parameter, measure, p.* FROM (SELECT gesture, style, s.parameter, s.measure, "
        f"unnest(s.played) AS p FROM (SELECT gesture, style, unnest(series) AS s FROM {READ_JSON}))"
    },
    METRICS_FILE: {"figures": "SELECT * FROM read_json(?)"},
    DESIGNS_FILE: {
        "designs": f"SELECT d.* EXCLUDE (performed, changes) FROM (SELECT unnest(designs) AS d FROM {READ_JSON})"
    },
}


@dataclass(frozen=True)
class QueryResult:
    """Columns and rows that an SQL query returns."""

    columns: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]


@dataclass(frozen=True, eq=False)
class Store:
    """SQL access to the results in a folder."""

    connection: "DuckDBPyConnection"
    tables: tuple[str, ...]

    def ask(self, query: str) -> QueryResult:
        """Run an SQL query on the results.

        Raises:
            ConfigError: the query is invalid.
        """
        import duckdb  # noqa: PLC0415 - an extra, which is there: the store is open

        try:
            cursor = self.connection.execute(query)
            return QueryResult(tuple(column[0] for column in cursor.description or ()), tuple(cursor.fetchall()))
        except duckdb.Error as error:
            names = ", ".join(self.tables)
            reason, *_ = str(error).splitlines() or ["DuckDB states no reason"]
            raise ConfigError(f"invalid query: {reason}; tables are {names}") from None


@contextmanager
def open_store(folder: Path) -> Iterator[Store]:
    """Open a folder's results for SQL, updating outdated Parquet tables.

    Args:
        folder: folder of a run; each NAME.parquet in it is a table NAME.

    Raises:
        ConfigError: duckdb is not installed, or there are no results.
    """
    try:
        import duckdb  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise ConfigError(f"results need duckdb: {install_extra('store')}") from None
    with duckdb.connect() as connection:
        connection.execute("SET enable_progress_bar_print = false")  # it would mix with printed rows
        for source, tables in TABLE_QUERIES.items():
            if (folder / source).exists():
                for name, select in tables.items():
                    _update_table(connection, folder / f"{name}.parquet", folder / source, select)
        paths = sorted(folder.glob("*.parquet"))
        if not paths:
            raise ConfigError(f"{folder}: no results; `kinesic validate DOCUMENTS --out {folder}` makes some")
        for path in paths:
            view = path.stem.replace('"', '""')
            connection.execute(f"CREATE VIEW \"{view}\" AS SELECT * FROM read_parquet('{_quoted(path)}')")
        yield Store(connection, tuple(path.stem for path in paths))


def _update_table(connection: "DuckDBPyConnection", path: Path, source: Path, select: str) -> None:
    """Write a Parquet table, unless it is newer than its source."""
    if path.exists() and path.stat().st_mtime_ns > source.stat().st_mtime_ns:
        return
    with new_file(path, force=True) as fresh:
        text = select.replace("?", f"'{_quoted(source)}'")
        connection.execute(f"COPY ({text}) TO '{_quoted(fresh)}' (FORMAT parquet, COMPRESSION zstd)")


def _quoted(path: Path) -> str:
    return str(path).replace("'", "''")
