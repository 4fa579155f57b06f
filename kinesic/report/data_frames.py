"""Tables of a performance as pandas data frames."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError, suggestion
from kinesic.extras import install_extra
from kinesic.importing import import_at_once
from kinesic.report.verdict import rows_of

if TYPE_CHECKING:
    from types import ModuleType

    from pandas import DataFrame

    from kinesic.report.run import Performance

FrameName = Literal["motion", "servos", "syncs", "behaviours", "checks"]
BEHAVIOUR_KEYS = ("id", "name", "type", "outcome", "why", "reason")  # keys of report.json shown in a data frame


def make_data_frame(run: "Performance", name: FrameName) -> "DataFrame":
    """Return one table of a performance as a data frame.

    Args:
        run: performance.
        name: "motion": every 10 ms, columns (quantity, hinge), in rad, rad/s and fractions of full PWM; "servos":
            likewise for each reading of the servos; "syncs": sync points in block time [s]; "behaviours": outcomes with
            start and end in block time [s]; "checks": values with their limits.

    Raises:
        ConfigError: pandas is missing, the name is unknown, or no servos performed.
    """
    pandas = import_pandas()
    match name:
        case "motion":
            return _hinge_frame(pandas, run, run.measured.times, dict(_twin_columns(run)))
        case "servos":
            return _servo_frame(pandas, run)
        case "syncs":
            rows = [
                (sync.behaviour, sync.sync, sync.is_stroke, sync.requested, sync.planned, sync.performed)
                for sync in run.syncs
            ]
            headings = ["behaviour", "sync", "is_stroke", "requested", "planned", "performed"]
            table: DataFrame = pandas.DataFrame(rows, columns=headings)
            return table.astype({"requested": float, "planned": float, "performed": float})
        case "behaviours":
            return _behaviour_frame(pandas, run)
        case "checks":
            checks: DataFrame = pandas.DataFrame(rows_of(run.data, "checks")).set_index("name")
            return checks
        case _:
            raise ConfigError(f"no table {name!r}{suggestion(name, get_args(FrameName))}")


def import_pandas() -> "ModuleType":
    """Import and return pandas, which is optional.

    Raises:
        ConfigError: pandas is missing; the message says how to install it.
    """
    try:
        return import_at_once("pandas")
    except ModuleNotFoundError as error:
        raise ConfigError(f"to_dataframe needs {error.name}: {install_extra('notebook')}") from None


def _twin_columns(run: "Performance") -> Iterator[tuple[str, Floats]]:
    """Yield names and values (m, n) of the plan's and twin's motion."""
    plan, measured, desired = run.plan, run.measured, run.plan.desired
    yield "requested", desired.sample(measured.times - plan.trajectory.zero + desired.zero)[0]
    yield "planned", run.reference.angles
    yield "setpoint", measured.setpoints
    yield "measured", measured.angles
    yield "velocity", measured.velocities
    yield "duty", measured.duties


def _servo_frame(pandas: "ModuleType", run: "Performance") -> "DataFrame":
    servos = run.servos
    if servos is None:
        raise ConfigError("the table 'servos' needs a performance on servos: perform(plan, on='servos', ports=...)")
    planned = run.plan.trajectory.sample(servos.times)[0]
    columns = {"planned": planned, "setpoint": servos.setpoints, "measured": servos.interpolated_angles}
    return _hinge_frame(pandas, run, servos.times, columns)


def _hinge_frame(pandas: "ModuleType", run: "Performance", times: Floats, quantities: dict[str, Floats]) -> "DataFrame":
    """Return a frame with one row per time and columns (quantity, hinge)."""
    hinges = run.plan.setup.robot.skeleton.names
    columns = pandas.MultiIndex.from_product([list(quantities), hinges], names=["quantity", "hinge"])
    index = pandas.Index(np.asarray(times), name="time")
    frame: DataFrame = pandas.DataFrame(np.hstack(list(quantities.values())), index=index, columns=columns)
    return frame


def _behaviour_frame(pandas: "ModuleType", run: "Performance") -> "DataFrame":
    spans: dict[str, list[float]] = {}
    for sync in run.plan.syncs:
        spans.setdefault(sync.behaviour, []).append(sync.planned)
    rows = [
        [*(row[key] for key in BEHAVIOUR_KEYS), min(times, default=np.nan), max(times, default=np.nan)]
        for row in rows_of(run.data, "behaviours")
        for times in [spans.get(str(row["id"]), [])]
    ]
    frame: DataFrame = pandas.DataFrame(rows, columns=[*BEHAVIOUR_KEYS, "start", "end"]).set_index("id")
    return frame
