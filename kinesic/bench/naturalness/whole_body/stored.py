"""Reader and writer of the measured statistics in `configs/captured_bodies.toml`."""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache

import msgspec

from kinesic.bench.naturalness.whole_body.features import MeasuredSet
from kinesic.bench.naturalness.whole_body.measures import MEASURE_NAMES, WholeBodyMeasures
from kinesic.bench.naturalness.whole_body.posture import POSTURE_NAMES, StandingPosture
from kinesic.body.config import CONFIGS, read_toml

TABLE_FILE = CONFIGS / "captured_bodies.toml"
OPTIONAL_MEASURES = ("stroke_speed", "stroke_path", "flow")  # measures that need sync points
MISSING_VALUE = -1.0  # stored value of a measure that is not available
SIGNIFICANT_DIGITS = 4  # digits of stored values
LINE_WIDTH = 118  # characters of a written line


class SetTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML columns with the measures of one captured set."""

    performances: tuple[str, ...]
    measures: Mapping[str, tuple[float, ...]]
    rests: tuple[str, ...]
    postures: Mapping[str, tuple[float, ...]]


class CapturedBodyTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Measures of all captured sets by name."""

    sets: Mapping[str, SetTable]


@cache
def read_captured_sets() -> tuple[MeasuredSet, ...]:
    """Read the supplied measures of captured clips, set by set.

    Raises:
        ConfigError: the table is missing or invalid.
    """
    table = read_toml(TABLE_FILE, CapturedBodyTable)
    return tuple(_to_set(name, columns) for name, columns in table.sets.items())


def format_sets(sets: Iterable[MeasuredSet]) -> str:
    """Return measured sets as the TOML text of `captured_bodies.toml`."""
    lines: list[str] = []
    for measured in sets:
        title = f'sets."{measured.name}"'
        lines += [f"[{title}]"]
        lines += _format_column("performances", [f'"{name}"' for name in measured.performances])
        lines += _format_column("rests", [f'"{name}"' for name in measured.rests])
        lines += ["", f"[{title}.measures]"]
        for name in MEASURE_NAMES:
            lines += _format_column(name, [_format(getattr(row, name)) for row in measured.gestures])
        lines += ["", f"[{title}.postures]"]
        for name in POSTURE_NAMES:
            lines += _format_column(name, [_format(getattr(row, name)) for row in measured.postures])
        lines += [""]
    return "\n".join(lines)


def _to_set(name: str, columns: SetTable) -> MeasuredSet:
    gestures = [  # the keys are the names of the fields, which the type checker cannot see
        WholeBodyMeasures(**{key: _to_value(key, columns.measures[key][k]) for key in MEASURE_NAMES})  # type: ignore[arg-type]
        for k in range(len(columns.performances))
    ]
    postures = [
        StandingPosture(**{key: columns.postures[key][k] for key in POSTURE_NAMES}) for k in range(len(columns.rests))
    ]
    return MeasuredSet(name, tuple(gestures), columns.performances, tuple(postures), columns.rests)


def _to_value(name: str, value: float) -> float | None:
    return None if name in OPTIONAL_MEASURES and value == MISSING_VALUE else value


def _format(value: float | None) -> str:
    return repr(MISSING_VALUE) if value is None else f"{float(f'{value:.{SIGNIFICANT_DIGITS}g}')!r}"


def _format_column(name: str, cells: Sequence[str]) -> list[str]:
    """Return the lines of one column, broken at `LINE_WIDTH`."""
    lines, line = [f"{name} = ["], "   "
    for cell in cells:
        if len(line) + len(cell) + 2 > LINE_WIDTH:
            lines, line = [*lines, line], "   "
        line += f" {cell},"
    return [*lines, line, "]"]
