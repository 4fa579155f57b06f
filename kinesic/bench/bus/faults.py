"""Comparison of servo-bus drivers under injected faults.

Metrics, tables and records of the fault matrix.

Everything runs in virtual time, so the metrics depend on wire, servos and driver but not on the machine's load.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic.bench.bus.drivers import KinesicDriver, LerobotDriver, SdkDriver, why_lerobot_is_missing
from kinesic.bench.bus.matrix import (
    BUS_PERIOD,
    DriverFactory,
    FaultCase,
    TrialResult,
    list_cases,
    run_matrix,
    run_trial,
)
from kinesic.bench.metric import Metric

SERVO_COUNT = 14  # number of servos on the bus with kinesic's driver
BAUD_RATE = 1_000_000  # [bit/s] baud rate of the bus with kinesic's driver
FAULT_SEEDS = (0, 1, 2)  # seeds of the random faults
MATRIX_SERVO_COUNTS = (7, 14, 26)  # numbers of servos at which drivers are compared
MATRIX_BAUD_RATES = (57_600, 1_000_000, 4_000_000)  # [bit/s] baud rates at which drivers are compared under faults
MIN_FRESH_PERCENTAGE = 99.9  # [%] goal for the fraction of readable positions that arrive, even late, at 1 % faults
MAX_P99_DURATION = 1.0  # [periods] goal of the 99th percentile of bus cycle durations
MAX_REPORT_DELAY = 1.0  # [periods] goal of the delay from a hardware error to its report
MAX_WRONG_COUNT = 0.0  # goal of the number of exceptions and wrong positions
DRIVER_FACTORIES: Mapping[str, DriverFactory] = {
    KinesicDriver.name: KinesicDriver,
    SdkDriver.name: SdkDriver,
    LerobotDriver.name: LerobotDriver,
    f"{LerobotDriver.name}, 3 retries": partial(LerobotDriver, retries=3),
}
MISSING_REASONS: Mapping[str, Callable[[], str]] = {
    name: why_lerobot_is_missing for name in DRIVER_FACTORIES if LerobotDriver.name in name
}
MAX_CELL_WIDTH = 12  # [characters] width from which a row's fourth cell is a message, which widens no column
TABLE_COLUMNS = (
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
    "reported ms",
)


def bench() -> list[Metric]:
    """Measure kinesic's bus under every fault, with 14 servos at 1 Mbaud."""
    metrics: list[Metric] = []
    for case in list_cases():
        results = [
            run_trial(case, KinesicDriver, servos=SERVO_COUNT, baud=BAUD_RATE, seed=seed) for seed in FAULT_SEEDS
        ]
        metrics += _fault_metrics(case, results)
    return metrics


def _fault_metrics(case: FaultCase, results: Sequence[TrialResult]) -> Iterator[Metric]:
    """Yield the metrics of the driver under one bus fault.

    Refused servos have only the count of wrong values.
    """
    name = f"bus.fault.{_slug(case.name)}"
    wrong = sum(result.exceptions + result.wrong for result in results)
    refused = next((result.refused for result in results if result.refused), "")
    yield Metric(
        f"{name}.wrong",
        wrong,
        "exceptions and wrong values",
        MAX_WRONG_COUNT,
        "lower",
        why=refused and f"refused: {refused}",
    )
    if refused:
        return
    if "1%" in case.name:
        fresh = 100 * float(np.mean([result.fresh for result in results]))
        yield Metric(f"{name}.fresh", fresh, "%", MIN_FRESH_PERCENTAGE, "higher")
    durations = np.concatenate([result.durations for result in results])
    yield Metric(f"{name}.p99", float(np.percentile(durations, 99)) / BUS_PERIOD, "periods", MAX_P99_DURATION, "lower")
    reported = [result.reported for result in results if result.reported is not None]
    if reported:
        yield Metric(f"{name}.told", max(reported) / BUS_PERIOD, "periods", MAX_REPORT_DELAY, "lower")


def _slug(name: str) -> str:
    return name.replace(" x ", "_").replace(" ", "_").replace("%", "")


@dataclass(frozen=True, eq=False)
class DriverTrials:
    """Results of one driver in the whole fault matrix."""

    driver: str
    why: str  # reason why the driver was not tried; empty if tried
    results: Sequence[TrialResult]

    def __str__(self) -> str:
        return f"{self.driver}\n\n{f'null: {self.why}' if self.why else format_table(self.results)}\n"

    def record(self) -> dict[str, object]:
        """Return all trials of the driver as a JSON-compatible record."""
        return {"driver": self.driver, "why": self.why, "trials": [record(result) for result in self.results]}


def compare_drivers(
    *,
    sizes: Sequence[int] = MATRIX_SERVO_COUNTS,
    bauds: Sequence[int] = MATRIX_BAUD_RATES,
    seeds: Sequence[int] = FAULT_SEEDS,
) -> Iterator[DriverTrials]:
    """Yield each driver's fault-matrix results, or why the driver is missing.

    This takes many minutes.
    """
    for name, make_driver in DRIVER_FACTORIES.items():
        why = MISSING_REASONS.get(name, str)()
        yield DriverTrials(
            name, why, [] if why else list(run_matrix(make_driver, sizes=sizes, bauds=bauds, seeds=seeds))
        )


def table_rows(results: Sequence[TrialResult]) -> list[tuple[str, ...]]:
    """Return table rows by fault, servo count and baud rate.

    A row combines all seeds.
    """
    groups: dict[tuple[str, int, int], list[TrialResult]] = {}
    for result in results:
        groups.setdefault((result.case, result.servos, result.baud), []).append(result)
    return [_row(name, servos, baud, group) for (name, servos, baud), group in groups.items()]


def _row(name: str, servos: int, baud: int, group: Sequence[TrialResult]) -> tuple[str, ...]:
    refused = next((result.refused for result in group if result.refused), "")
    if refused:
        return name, str(servos), str(baud), refused, *[""] * (len(TABLE_COLUMNS) - 4)
    durations = np.concatenate([result.durations for result in group])
    reported = [result.reported for result in group if result.reported is not None]
    timings = (*(np.percentile(durations, percent) for percent in (50, 99)), durations.max())
    return (
        name,
        str(servos),
        str(baud),
        str(sum(result.exceptions for result in group)),
        str(sum(result.wrong for result in group)),
        f"{100 * np.mean([result.fresh for result in group]):.2f}",
        f"{1000 * max(result.oldest for result in group):.1f}",
        *(f"{1000 * timing:.2f}" for timing in timings),
        f"{1000 * max(reported):.1f}" if reported else "",
    )


def record(result: TrialResult) -> dict[str, str | float | None]:
    """Return one fault trial as a JSON-compatible record.

    Fractions in 0..1, times in seconds.
    """
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


def format_table(results: Sequence[TrialResult]) -> str:
    """Format the comparison of drivers as aligned lines of text."""
    lines = [TABLE_COLUMNS, *table_rows(results)]
    widths = [
        max(len(line[k]) for line in lines if len(line[3]) < MAX_CELL_WIDTH or k < 3) for k in range(len(TABLE_COLUMNS))
    ]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )
