"""Write the measurements of `kinesic bench bus --json` and `--matrix --json` into docs/benchmarks/servos.md."""

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

PAGE = Path(__file__).parents[1] / "benchmarks/servos.md"
COUNTS, BAUDS = (7, 14, 20, 26), {57_600: "57 600", 1_000_000: "1 M", 2_000_000: "2 M", 4_000_000: "4 M"}
SERVOS, BAUD = 14, 1_000_000  # number of servos and baud rate in the comparison of the drivers
DRIVERS = ("kinesic", "dynamixel-sdk")
REPORTED_FAULTS = ("alert", "overheat", "undervoltage")  # cases in which a servo reports a hardware error

Trial = dict[str, str | float | None]
Trials = dict[str, list[Trial]]  # by case, in the order of the matrix

figures = {figure["name"]: figure["value"] for figure in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))}
drivers = {each["driver"]: each["trials"] for each in json.loads(Path(sys.argv[2]).read_text(encoding="utf-8"))}


def table(*rows: Sequence[str]) -> list[str]:
    """Format rows as a Markdown table, the first row as header."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:]]


def by_case(trials: Sequence[Trial]) -> Trials:
    """Group trials by case."""
    groups: Trials = {}
    for trial in trials:
        groups.setdefault(str(trial["case"]), []).append(trial)
    return groups


def format_rates() -> list[str]:
    """Tabulate the bus load by number of servos and baud rate."""
    rows = [[f"{figures[f'bus.rate_{count}_servos_{baud}_baud']:.1f} %" for baud in BAUDS] for count in COUNTS]
    return table(("servos", *BAUDS.values()), *[(str(count), *row) for count, row in zip(COUNTS, rows, strict=True)])


def summarise(trials: Sequence[Trial]) -> tuple[str, str, str, str]:
    """Summarise a driver's results under one fault over all seeds."""
    refused = next((str(trial["refused"]) for trial in trials if trial["refused"]), "")
    if refused:
        return f"refused: {refused.partition(': ')[2].partition(';')[0]}", "", "", ""
    wrong = " / ".join(str(sum(trial[name] for trial in trials)) for name in ("exceptions", "wrong"))
    fresh = 100 * sum(trial["fresh"] for trial in trials) / len(trials)
    delays = [trial["told_s"] for trial in trials]
    reported = ""
    if str(trials[0]["case"]).startswith(REPORTED_FAULTS):
        reported = "never" if None in delays else milliseconds(max(delays))
    return wrong, f"{fresh:.2f}", milliseconds(max(trial["p99_s"] for trial in trials)), reported


def milliseconds(seconds: float) -> str:
    """Format a duration [ms] with one decimal."""
    return f"{1000 * seconds:.1f}"


def compare_drivers() -> list[str]:
    """Tabulate each driver's fraction of fresh positions and its cycle time."""
    head = [f"{name}: {column}" for column in ("fresh [%]", "cycle time, p99 [ms]") for name in DRIVERS]
    rows = {fault: [each[k] for k in (1, 2) for each in results] for fault, results in summarise_faults().items()}
    return table(("fault", *head), *[(fault, *row) for fault, row in rows.items()])


def compare_errors() -> list[str]:
    """Tabulate the drivers' exceptions, wrong positions and error reports.

    Faults without any of the three are omitted.
    """
    columns = ("exceptions / wrong positions", "reported after [ms]")
    head = [f"{name}: {column}" for column in columns for name in DRIVERS]
    rows = {fault: [each[k] for k in (0, 3) for each in results] for fault, results in summarise_faults().items()}
    shown = {fault: row for fault, row in rows.items() if {*row} - {"0 / 0", ""}}
    return table(("fault", *head), *[(fault, *row) for fault, row in shown.items()])


def summarise_faults() -> dict[str, list[tuple[str, str, str, str]]]:
    """Summarise each driver by fault, at `SERVOS` servos and `BAUD` baud."""
    cases = [
        by_case([trial for trial in drivers[name] if (trial["servos"], trial["baud"]) == (SERVOS, BAUD)])
        for name in DRIVERS
    ]
    return {fault.replace("_", " "): [summarise(each[fault]) for each in cases] for fault in cases[0]}


def format_worst() -> list[str]:
    """Tabulate each fault's lowest mean freshness and longest cycle."""
    rows = []
    for name, trials in by_case(drivers["kinesic"]).items():
        if any(trial["refused"] for trial in trials) or name.startswith(REPORTED_FAULTS[0]):
            continue
        places: dict[tuple[float, float], list[Trial]] = {}
        for trial in trials:
            places.setdefault((trial["servos"], trial["baud"]), []).append(trial)
        least = min(places, key=lambda place: mean(places[place], "fresh"))
        fresh, prompt = (min(mean(each, what) for each in places.values()) for what in ("fresh", "prompt"))
        fraction = max(trial["p99_s"] / trial["period_s"] for trial in trials)
        where = "all" if fresh == 1.0 else f"{least[0]}, {BAUDS[least[1]]}"
        rows.append((name, f"{100 * fresh:.2f}", f"{100 * prompt:.2f}", where, f"{100 * fraction:.0f}"))
    return table(
        (
            "fault",
            "fresh [%]",
            "arrived in their own cycle [%]",
            "servos, baud rate of the lowest value",
            "cycle time, p99 [% of the period]",
        ),
        *rows,
    )


def mean(trials: Sequence[Trial], what: str) -> float:
    """Return the mean of one metric over trials."""
    return sum(trial[what] for trial in trials) / len(trials)


TABLES: dict[str, Callable[[], list[str]]] = {
    "rates": format_rates,
    "drivers": compare_drivers,
    "errors": compare_errors,
    "worst": format_worst,
}
text = PAGE.read_text(encoding="utf-8")
for mark, made in TABLES.items():
    before, rest = text.split(f"<!-- {mark} -->")
    after = rest.split(f"<!-- end of {mark} -->")[1]
    text = "\n".join([f"{before}<!-- {mark} -->", "", *made(), "", f"<!-- end of {mark} -->{after}"])
PAGE.write_text(text, encoding="utf-8")
