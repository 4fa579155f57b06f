"""Compares drivers under faults: the fault matrix as figures, as a table and as records.

Everything is in virtual time: the figures are those of wire, servos and driver, whatever the machine does meanwhile.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic.bench.bus.drivers import KinesicDriver, LerobotDriver, SdkDriver, lerobot_missing
from kinesic.bench.bus.matrix import PERIOD, FaultCase, Opens, TrialResult, cases, matrix, trial
from kinesic.bench.figure import Figure

SERVOS, BAUD, SEEDS = 14, 1_000_000, (0, 1, 2)
SIZES, BAUDS = (7, 14, 26), (57_600, 1_000_000, 4_000_000)  # of the whole matrix
FRESH, P99, TOLD, WRONG = 99.9, 1.0, 1.0, 0.0  # [%] at 1 % faults, [periods], [periods], [count]
DRIVERS: Mapping[str, Opens] = {
    KinesicDriver.name: KinesicDriver,
    SdkDriver.name: SdkDriver,
    LerobotDriver.name: LerobotDriver,
    f"{LerobotDriver.name}, 3 retries": partial(LerobotDriver, retries=3),
}
MISSING: Mapping[str, Callable[[], str]] = {name: lerobot_missing for name in DRIVERS if LerobotDriver.name in name}
REASON = 12  # [characters] longer than any figure: why a driver would not drive
COLUMNS = (
    "fault",
    "servos",
    "baud",
    "exceptions",
    "wrong",
    "fresh %",
    "oldest ms",
    "p50 ms",
    "p99 ms",
    "max ms",
    "told ms",
)


def bench() -> list[Figure]:
    """Measures every fault for 14 servos at 1 Mbaud, the seeds together."""
    figures: list[Figure] = []
    for case in cases():
        found = [trial(case, KinesicDriver, servos=SERVOS, baud=BAUD, seed=seed) for seed in SEEDS]
        figures += _figures(case, found)
    return figures


def _figures(case: FaultCase, found: Sequence[TrialResult]) -> Iterator[Figure]:
    """What a fault must not do; a servo that must be refused has no other figures."""
    name = f"bus.fault.{_slug(case.name)}"
    wrong = sum(result.exceptions + result.wrong for result in found)
    refused = next((result.refused for result in found if result.refused), "")
    yield Figure(
        f"{name}.wrong", wrong, "exceptions and wrong values", WRONG, "lower", why=refused and f"refused: {refused}"
    )
    if refused:
        return
    if "1%" in case.name:
        fresh = 100 * float(np.mean([result.fresh for result in found]))
        yield Figure(f"{name}.fresh", fresh, "%", FRESH, "higher")
    durations = np.concatenate([result.durations for result in found])
    yield Figure(f"{name}.p99", float(np.percentile(durations, 99)) / PERIOD, "periods", P99, "lower")
    reported = [result.reported for result in found if result.reported is not None]
    if reported:
        yield Figure(f"{name}.told", max(reported) / PERIOD, "periods", TOLD, "lower")


def _slug(name: str) -> str:
    return name.replace(" x ", "_").replace(" ", "_").replace("%", "")


@dataclass(frozen=True, eq=False)
class DriverTrials:
    """What one driver did in the whole matrix."""

    driver: str
    why: str  # it was not tried; empty where it was
    results: Sequence[TrialResult]

    def __str__(self) -> str:
        return f"{self.driver}\n\n{f'null: {self.why}' if self.why else text(self.results)}\n"

    def record(self) -> dict[str, object]:
        """Returns the trials for a machine to read."""
        return {"driver": self.driver, "why": self.why, "trials": [record(result) for result in self.results]}


def compare_drivers(
    *, sizes: Sequence[int] = SIZES, bauds: Sequence[int] = BAUDS, seeds: Sequence[int] = SEEDS
) -> Iterator[DriverTrials]:
    """Runs the whole matrix for every driver that is installed; it takes many minutes."""
    for name, opens in DRIVERS.items():
        why = MISSING.get(name, str)()
        yield DriverTrials(name, why, [] if why else list(matrix(opens, sizes=sizes, bauds=bauds, seeds=seeds)))


def rows(results: Sequence[TrialResult]) -> list[tuple[str, ...]]:
    """Makes the table of the matrix, one row for each fault, size and rate, the seeds together."""
    groups: dict[tuple[str, int, int], list[TrialResult]] = {}
    for result in results:
        groups.setdefault((result.case, result.servos, result.baud), []).append(result)
    return [_row(name, servos, baud, group) for (name, servos, baud), group in groups.items()]


def _row(name: str, servos: int, baud: int, group: Sequence[TrialResult]) -> tuple[str, ...]:
    refused = next((result.refused for result in group if result.refused), "")
    if refused:
        return name, str(servos), str(baud), refused, *[""] * (len(COLUMNS) - 4)
    every = np.concatenate([result.durations for result in group])
    reported = [result.reported for result in group if result.reported is not None]
    figures = (*(np.percentile(every, percent) for percent in (50, 99)), every.max())
    return (
        name,
        str(servos),
        str(baud),
        str(sum(result.exceptions for result in group)),
        str(sum(result.wrong for result in group)),
        f"{100 * np.mean([result.fresh for result in group]):.2f}",
        f"{1000 * max(result.oldest for result in group):.1f}",
        *(f"{1000 * figure:.2f}" for figure in figures),
        f"{1000 * max(reported):.1f}" if reported else "",
    )


def record(result: TrialResult) -> dict[str, str | float | None]:
    """Writes one trial for a machine: shares from 0 to 1, times in seconds."""
    return {
        "case": result.case,
        "servos": result.servos,
        "baud": result.baud,
        "seed": result.seed,
        "period_s": result.period,
        "refused": result.refused,
        "exceptions": result.exceptions,
        "wrong": result.wrong,
        "fresh": result.fresh,
        "prompt": result.prompt,
        "oldest_s": result.oldest,
        "p99_s": result.duration(99),
        "told_s": result.reported,
    }


def text(results: Sequence[TrialResult]) -> str:
    """Writes the table as lines of text."""
    lines = [COLUMNS, *rows(results)]
    widths = [max(len(line[k]) for line in lines if len(line[3]) < REASON or k < 3) for k in range(len(COLUMNS))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )
