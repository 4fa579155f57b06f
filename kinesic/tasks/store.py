"""Results of many tasks as Parquet: tables that are made of a run's journal, and asked in SQL."""

from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.output_file import new_file

ENTRY = (
    "STRUCT(file VARCHAR, outcome VARCHAR, exit INTEGER, error VARCHAR, report VARCHAR, behaviours VARCHAR[][], "
    'checks STRUCT(name VARCHAR, status VARCHAR, "value" DOUBLE, "limit" DOUBLE, unit VARCHAR, "where" VARCHAR)[])'
)
COLUMNS = f"{{'key': 'VARCHAR', 'entry': '{ENTRY}'}}"
READ = f"read_json(?, format='newline_delimited', columns={COLUMNS}, ignore_errors=true)"
LINES = f"(SELECT * FROM {READ} WHERE entry.file IS NOT NULL)"  # a line that is not whole is a row of nothing
TABLES = {
    "documents": f"SELECT key, entry.file, entry.outcome, entry.exit, entry.error, entry.report FROM {LINES}",
    "behaviours": f"SELECT file, b[1] AS type, b[2] AS outcome FROM "
    f"(SELECT entry.file AS file, unnest(entry.behaviours) AS b FROM {LINES})",
    "checks": f"SELECT file, c.* FROM (SELECT entry.file AS file, unnest(entry.checks) AS c FROM {LINES})",
}


@dataclass(frozen=True)
class Answer:
    """What a query found."""

    columns: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]


def ask(folder: Path, query: str, journal: str) -> Answer:
    """Asks the results of a folder in SQL; tables that are older than its journal are written anew.

    Args:
        folder: of a run; each NAME.parquet in it is a table NAME.
        query: in SQL.
        journal: name of the file of finished work, of which the tables are made.

    Raises:
        ConfigError: duckdb is not installed, there are no results, or the query is wrong.
    """
    try:
        import duckdb  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise ConfigError("results need duckdb: pip install 'kinesic[store]'") from None
    with duckdb.connect() as connection:
        source = folder / journal
        for name, select in TABLES.items():
            path = folder / f"{name}.parquet"
            if source.exists() and (not path.exists() or path.stat().st_mtime_ns <= source.stat().st_mtime_ns):
                with new_file(path, force=True) as fresh:
                    text = select.replace("?", f"'{_quoted(source)}'")
                    connection.execute(f"COPY ({text}) TO '{_quoted(fresh)}' (FORMAT parquet, COMPRESSION zstd)")
        tables = sorted(folder.glob("*.parquet"))
        if not tables:
            raise ConfigError(f"{folder}: no results; `kinesic validate DOCUMENTS --out {folder}` makes some")
        for path in tables:
            connection.execute(f"CREATE VIEW \"{path.stem}\" AS SELECT * FROM read_parquet('{_quoted(path)}')")
        try:
            found = connection.execute(query)
            return Answer(tuple(column[0] for column in found.description or ()), tuple(found.fetchall()))
        except duckdb.Error as error:
            names = ", ".join(path.stem for path in tables)
            raise ConfigError(f"the query is wrong: {str(error).splitlines()[0]}; tables are {names}") from None


def _quoted(path: Path) -> str:
    return str(path).replace("'", "''")
