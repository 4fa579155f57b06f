"""Measures how long a store of a million rows takes to be made of a journal, and to be asked."""

from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

import msgspec

from kinesic.bench.figure import Figure
from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks.check import Check
from kinesic.tasks.journal import JournalLine
from kinesic.tasks.store import JOURNAL, open_store

ROWS = 1_000_000  # of checks
CHECKS = 29  # of a document
QUICK = 1.0  # [s] goal for each question
QUESTIONS = (
    "SELECT name, count(*), quantile_cont(c.value, [0.5, 0.95]) FROM checks c GROUP BY name ORDER BY name",
    "SELECT file, c.value, c.where FROM checks c WHERE name = 'check.7' ORDER BY c.value DESC LIMIT 10",
    "SELECT status, count(*) FROM checks GROUP BY status",
    "SELECT outcome, max(c.value) FROM documents JOIN checks c USING (file) GROUP BY outcome",
)
NO_DUCKDB = "duckdb is not installed: pip install 'kinesic[store]'"


def bench() -> list[Figure]:
    """Measures the making of the tables, and the slowest of some questions, each asked in a store opened anew."""
    if find_spec("duckdb") is None:
        return [Figure("store.query", None, "s", QUICK, "lower", NO_DUCKDB)]
    with TemporaryDirectory() as place:
        folder = Path(place)
        _write_journal(folder / JOURNAL, ROWS // CHECKS)
        began = process_time()
        with open_store(folder):
            made = process_time() - began
        taken = [_ask(folder, question) for question in QUESTIONS]
        size = sum(path.stat().st_size for path in folder.glob("*.parquet"))
    rows = f"{ROWS:,} checks"
    return [
        Figure("store.make", made, "s", None, "lower", f"CPU, {rows}"),
        Figure("store.size", size / 1e6, "MB", None, "lower", "of Parquet"),
        Figure("store.query", max(wall for wall, _ in taken), "s", QUICK, "lower", "the slowest question"),
        Figure("store.query_cpu", max(cpu for _, cpu in taken), "s", None, "lower", "CPU, likewise"),
    ]


def _ask(folder: Path, question: str) -> tuple[float, float]:
    """[s] until a store is open and has answered, and of CPU."""
    began, spent = perf_counter(), process_time()
    with open_store(folder) as store:
        store.ask(question)
    return perf_counter() - began, process_time() - spent


def _write_journal(path: Path, documents: int) -> None:
    with path.open("wb") as file:
        for number in range(documents):
            checks = tuple(
                Check(f"check.{k}", "fail" if (number + k) % 97 == 0 else "pass", number % 1009 / (k + 1), 1.0, "s", "")
                for k in range(CHECKS)
            )
            verdict = DocumentVerdict(f"{number}.bml", "performed", 0, (("gesture", "realised"),), checks)
            file.write(msgspec.json.encode(JournalLine(str(number), verdict)) + b"\n")
