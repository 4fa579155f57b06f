"""The fault matrix as a table, and as records."""

from collections.abc import Sequence

import numpy as np

from kinesic.hardware.virtual.matrix import TrialResult

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


def rows(results: Sequence[TrialResult]) -> list[tuple[str, ...]]:
    """The table of the matrix, one row for each fault, size and rate, the seeds together."""
    groups: dict[tuple[str, int, int], list[TrialResult]] = {}
    for result in results:
        groups.setdefault((result.case, result.servos, result.baud), []).append(result)
    return [_row(name, servos, baud, group) for (name, servos, baud), group in groups.items()]


def _row(name: str, servos: int, baud: int, group: Sequence[TrialResult]) -> tuple[str, ...]:
    refused = next((result.refused for result in group if result.refused), "")
    if refused:
        return name, str(servos), str(baud), refused, *[""] * (len(COLUMNS) - 4)
    every = np.concatenate([result.durations for result in group])
    told = [result.told for result in group if result.told is not None]
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
        f"{1000 * max(told):.1f}" if told else "",
    )


def record(result: TrialResult) -> dict[str, str | float | None]:
    """One trial for a machine to read: shares from 0 to 1, times in seconds."""
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
        "told_s": result.told,
    }


def text(results: Sequence[TrialResult]) -> str:
    """The table as lines of text."""
    lines = [COLUMNS, *rows(results)]
    widths = [max(len(line[k]) for line in lines if len(line[3]) < REASON or k < 3) for k in range(len(COLUMNS))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )
