"""Hand shapes in the words of the page."""

from collections.abc import Mapping

from kinesic.report.report import Json


def shapes_made(row: Mapping[str, Json]) -> str:
    """Says which shapes were asked for, and which of them the hand could not make; empty where none was.

    Args:
        row: of the report's behaviours.
    """
    shapes = row["shapes"]
    if not isinstance(shapes, dict):
        return ""
    asked, made = shapes["asked"], shapes["made"]
    if not (isinstance(asked, list) and isinstance(made, list)):
        return ""
    return ", ".join(str(shape) if shape in made else f"{shape} (not made)" for shape in asked)
