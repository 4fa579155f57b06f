"""Benchmark of the database of dry-run results.

It measures time to build it from a journal and to query it.

The journal holds about a million checks.
"""

from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

import msgspec

from kinesic.bench.metric import Metric
from kinesic.extras import install_extra
from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks.check import Check
from kinesic.tasks.journal import JournalLine
from kinesic.tasks.store import JOURNAL_FILE, open_store

CHECK_ROWS = 1_000_000  # report checks in the generated journal
CHECKS_PER_DOCUMENT = 29  # report checks per document
MAX_QUERY_TIME = 1.0  # [s] goal for each database query
BENCH_QUERIES = (
    "SELECT name, count(*), quantile_cont(c.value, [0.5, 0.95]) FROM checks c GROUP BY name ORDER BY name",
    "SELECT file, c.value, c.where FROM checks c WHERE name = 'check.7' ORDER BY c.value DESC LIMIT 10",
    "SELECT status, count(*) FROM checks GROUP BY status",
    "SELECT outcome, max(c.value) FROM documents JOIN checks c USING (file) GROUP BY outcome",
)


def bench() -> list[Metric]:
    """Measure the times to build and query a result database.

    The store is opened again before each query.
    """
    if find_spec("duckdb") is None:
        why = f"duckdb is not installed: {install_extra('store')}"
        return [Metric("store.query", None, "s", MAX_QUERY_TIME, "lower", why)]
    with TemporaryDirectory() as folder_name:
        folder = Path(folder_name)
        _write_journal(folder / JOURNAL_FILE, CHECK_ROWS // CHECKS_PER_DOCUMENT)
        began = process_time()
        with open_store(folder):
            build_time = process_time() - began
        times = [_time_query(folder, query) for query in BENCH_QUERIES]
        size = sum(path.stat().st_size for path in folder.glob("*.parquet"))
    rows = f"{CHECK_ROWS:,} checks"
    return [
        Metric("store.make", build_time, "s", None, "lower", f"CPU, {rows}"),
        Metric("store.size", size / 1e6, "MB", None, "lower", "Parquet files"),
        Metric("store.query", max(wall for wall, _ in times), "s", MAX_QUERY_TIME, "lower", "slowest query"),
        Metric("store.query_cpu", max(cpu for _, cpu in times), "s", None, "lower", "CPU, slowest query"),
    ]


def _time_query(folder: Path, query: str) -> tuple[float, float]:
    """Return wall and CPU time [s] of one database query."""
    began, spent = perf_counter(), process_time()
    with open_store(folder) as store:
        store.ask(query)
    return perf_counter() - began, process_time() - spent


def _write_journal(path: Path, documents: int) -> None:
    with path.open("wb") as file:
        for number in range(documents):
            checks = tuple(
                Check(f"check.{k}", "fail" if (number + k) % 97 == 0 else "pass", number % 1009 / (k + 1), 1.0, "s", "")
                for k in range(CHECKS_PER_DOCUMENT)
            )
            verdict = DocumentVerdict(f"{number}.bml", "performed", 0, (("gesture", "realised"),), checks)
            file.write(msgspec.json.encode(JournalLine(str(number), verdict)) + b"\n")
