"""Description of hand shapes on the report page."""

from collections.abc import Mapping

from kinesic.report.report import Json


def shapes_made(row: Mapping[str, Json]) -> str:
    """List a behaviour's requested hand shapes, marking infeasible ones.

    Args:
        row: row of the report's behaviours.
    """
    shapes = row["shapes"]
    if not isinstance(shapes, dict):
        return ""
    requested, feasible = shapes["asked"], shapes["made"]
    if not (isinstance(requested, list) and isinstance(feasible, list)):
        return ""
    return ", ".join(str(shape) if shape in feasible else f"{shape} (not made)" for shape in requested)
