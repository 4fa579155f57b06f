"""Report page of a performance as one self-contained HTML file."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup, escape

from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, MODALITIES
from kinesic.metrics.conditioning import find_deviations
from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.servos import CONTINUOUS_TORQUE_RATIO, draw_load, loads
from kinesic.report.content_policy import content_policy
from kinesic.report.document_lines import document_lines
from kinesic.report.plots.hands import hands
from kinesic.report.plots.joints import HingeCurves, joints, still_hinges
from kinesic.report.plots.margins import margins
from kinesic.report.plots.score import scores
from kinesic.report.plots.spark import spark
from kinesic.report.replay import replay_data
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, TEMPLATES_FOLDER, read_scripts
from kinesic.report.shapes import shapes_made
from kinesic.report.transcript import transcribe
from kinesic.report.verdict import format_number, rows_of, severity_rank, verdict

FILM_TYPES = {  # MIME types of films, by suffix
    ".webp": "image/webp",
    ".png": "image/png",
    ".gif": "image/gif",
    ".mp4": "video/mp4",
}
SOUND_TYPES = {".wav": "audio/wav"}  # MIME types of sounds, by suffix
HAND_NAMES = {"l_hand": "left hand", "r_hand": "right hand"}  # names of the hands in texts, by body part
SHOWN_LOADS = 6  # number of joints visible before the reader expands the table of servo loads
MIN_SHOWN_ANGLE = 0.5  # [deg] body rotations smaller than this are not listed
SHOWN_CHANGES = 6  # number of changed behaviours visible before the reader expands the list of limit changes
OUTCOME_RANKS = {  # sort order of behaviour outcomes, the most severe first
    "dropped": 0,
    "substituted": 1,
    "partly": 2,
    "realised": 3,
}
PAGE_SCRIPTS = (*SCENE_SCRIPTS, "film.js", "replay.js")  # script files of the page, in loading order
GROUP_TITLES = {
    "meaning": "Meaning",
    "amplitude": "Amplitude",
    "limits": "Limits",
    "collision": "Clearance",
    "timing": "Timing",
    "tracking": "Tracking",
    "measured": "On the robot",
    "servo": "Servos",
}  # titles of check groups; other groups show their name
SMALL_UNITS = {"s": ("ms", 1000.0), "m": ("mm", 1000.0)}  # unit -> smaller unit and factor, for values below 1
UNIT_SYMBOLS = {"deg": "\u00b0", "times": "\u00d7"}  # symbols shown for units
UNSPACED_UNITS = {"\u00b0"}  # units written without a space after the number


@dataclass(frozen=True, kw_only=True)
class Recordings:
    """Films and sound shown on the report page."""

    film: Path | None = None  # film of the twin: .webp, .png, .gif or .mp4
    why_no_film: str = "not recorded"
    face: Path | None = None  # animated picture of the rendered face, .webp
    why_no_face: str = "not recorded"
    face_on_head: bool = False  # whether the replay shows this picture on the head, instead of a drawn face
    voice: Path | None = None  # speech as .wav, with which the replay is synchronised


NO_RECORDINGS = Recordings()  # default: no films and no sound


def write_page(
    performance: DryRun, data: Mapping[str, Json], recordings: Recordings = NO_RECORDINGS, *, path: Path
) -> None:
    """Write the report page of a performance.

    Args:
        performance: performance to plot.
        data: data of its report, for texts and tables.
        recordings: embedded into the page.
        path: path of the page.

    Raises:
        ValueError: a film or the sound has another type.
    """
    chapters, strained, rows = performance.reference.changes, loads(performance), rows_of(data, "behaviours")
    player, curves = read_scripts(PAGE_SCRIPTS), HingeCurves.of(performance)
    text = _template().render(
        data=data,
        verdict=verdict(data),
        look=Markup((TEMPLATES_FOLDER / "page.css").read_text(encoding="utf-8")),
        player=Markup(player),
        policy=content_policy(f"\n{player}\n", img_src="data: blob:", media_src="data:"),
        replay=replay_data(performance),
        tiles=tiles(rows_of(data, "checks")),
        checks=sorted(rows_of(data, "checks"), key=severity_rank),
        behaviours=sorted(rows, key=lambda row: OUTCOME_RANKS[str(row["outcome"])]),
        fates={row["id"]: row for row in rows},
        transcript=transcribe(performance.plan),
        document=document_lines(performance.plan.timeline.block),
        chapters=(chapters[:SHOWN_CHANGES], chapters[SHOWN_CHANGES:]),
        deviations=find_deviations(performance.plan),
        parts=HAND_NAMES,
        modalities=MODALITIES,
        parameters=list(EXPRESSIVITY_RANGES),
        loads=(strained[:SHOWN_LOADS], strained[SHOWN_LOADS:]),
        continuous=CONTINUOUS_TORQUE_RATIO,
        draw=draw_load(performance),
        film=_embedded(recordings.film, FILM_TYPES),
        no_film=recordings.why_no_film,
        face=_embedded(recordings.face, {".webp": FILM_TYPES[".webp"]}),
        no_face=recordings.why_no_face,
        face_on_head=recordings.face_on_head,
        voice=_embedded(recordings.voice, SOUND_TYPES),
        zero=performance.plan.trajectory.zero,
        scores=scores(performance.plan, performance.duration),
        joints=list(joints(performance, curves)),
        still=still_hinges(performance, curves),
        hands=hands(performance),
        margins=margins(performance),
    )
    path.write_bytes(text.encode("utf-8", errors="replace"))


@cache
def _template() -> Template:
    """Return the cached template of the page."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": format_number, "shift": format_shift, "spark": spark}
    environment.filters |= {
        "breakable": breakable,
        "departure": style_departures,
        "body": describe_body_motion,
        "shapes": shapes_made,
    }
    return environment.get_template("page.jinja")


def format_shift(seconds: float) -> str:
    """Format a time difference in whole milliseconds with its sign."""
    return f"{1000 * seconds:+.0f}\u2009ms".replace("-", "\u2212")


def describe_body_motion(row: Mapping[str, Json]) -> str:
    """Describe in words the body motion that accompanies a behaviour.

    The text is empty without such motion.

    Args:
        row: row of the report's behaviours.
    """
    body = row["body"]
    if not isinstance(body, dict):
        return ""
    angles = ((part, body[f"{part}_deg"]) for part in ("head", "trunk", "shoulders"))
    moved = [
        f"{part} {angle:.0f}°" for part, angle in angles if isinstance(angle, float) and abs(angle) >= MIN_SHOWN_ANGLE
    ]
    faces, left = body["face"], body["gave_way"]
    shown = list(faces) if isinstance(faces, dict) else []
    gave = [f"{part} left to others" for part in left] if isinstance(left, list) else []
    return ", ".join([*moved, *shown, *gave])


def style_departures(row: Mapping[str, Json], style: Mapping[str, Json]) -> str:
    """List the parameters of a behaviour that differ from the style.

    Args:
        row: row of the report's behaviours.
        style: style of the performance, as in the report.
    """
    manner = row["manner"]
    if not isinstance(manner, dict):
        return ""
    values, sources, style_values = manner["values"], manner["sources"], style[str(manner["modality"])]
    if not (isinstance(values, dict) and isinstance(sources, dict) and isinstance(style_values, dict)):
        return ""
    departures: dict[str, list[str]] = {}
    for name, value in values.items():
        if value != style_values[name]:
            departures.setdefault(str(sources[name]), []).append(
                f"{name} {format_number(value)}".replace("-", "\u2212")
            )
    return "; ".join(f"{', '.join(numbers)} ({source})" for source, numbers in departures.items())


COMPLETENESS_CHECKS = (
    "collision.pace",
    "collision.performed",
    "meaning.performed",
)  # checks of fractions that are 1 in a complete performance


@dataclass(frozen=True)
class Tile:
    """Summary of one group of checks on the page."""

    title: str
    status: str
    name: str  # name of the most severe check of the group
    value: str
    unit: str
    limit: str  # with its unit and `at least` or `at most`
    where: str
    others: int  # number of other checks in the group


def tiles(checks: Sequence[Mapping[str, Json]]) -> list[Tile]:
    """Summarise each group of checks as a tile.

    The group is the part of the name before the dot.

    Args:
        checks: rows of the report.
    """
    groups: dict[str, list[Mapping[str, Json]]] = {}
    for row in checks:
        groups.setdefault(str(row["name"]).split(".")[0], []).append(row)
    return [_tile(GROUP_TITLES.get(name, name.capitalize()), rows) for name, rows in groups.items()]


def _tile(title: str, rows: list[Mapping[str, Json]]) -> Tile:
    worst = min(rows, key=lambda row: (severity_rank(row), -_compute_limit_ratio(row)))
    unit = str(worst["unit"])
    value, shown = quantity(worst["value"], unit)
    limit, shown_unit = quantity(worst["limit"], unit)
    if value == limit and worst["status"] != "pass":
        value = f"{worst['value']:.7g}"  # shows on which side of the limit it is
    side = "at least" if worst["at_least"] else "at most"
    return Tile(
        title=title,
        status=str(worst["status"]),
        name=str(worst["name"]).split(".", 1)[-1].replace("_", " "),
        value=value,
        unit=shown,
        limit=f"{side} {limit}{'' if shown_unit in UNSPACED_UNITS else ' '}{shown_unit}".rstrip(),
        where=str(worst["where"]),
        others=len(rows) - 1,
    )


def _compute_limit_ratio(row: Mapping[str, Json]) -> float:
    """Return the ratio of a check's value to its limit, for ranking.

    It is limit / value if the limit is a minimum, and 0 for `COMPLETENESS_CHECKS`.
    """
    if row["name"] in COMPLETENESS_CHECKS:
        return 0.0
    value, limit = row["value"], row["limit"]
    if not isinstance(value, int | float) or not isinstance(limit, int | float) or not value or not limit:
        return 0.0
    return limit / value if row["at_least"] else value / limit


def quantity(value: Json, unit: str) -> tuple[str, str]:
    """Return a value as text, and the unit to display."""
    if isinstance(value, int | float) and unit in SMALL_UNITS and abs(value) < 1.0:
        unit, scale = SMALL_UNITS[unit]
        value = scale * value
    if isinstance(value, float) and unit == "ratio":
        return f"{value:.2f}", ""
    brief = f"{value:.2g}" if isinstance(value, float) and abs(value) < 0.1 else format_number(value)
    return brief.replace("-", "\u2212"), UNIT_SYMBOLS.get(unit, unit)


def breakable(name: str) -> Markup:
    """Allow line breaks in a name after its underscores."""
    return Markup(escape(name).replace("_", Markup("_<wbr>")))


def _embedded(file: Path | None, types: Mapping[str, str]) -> str | None:
    """Return a file's content as a data URI, or None without file."""
    if file is None:
        return None
    if file.suffix not in types:
        raise ValueError(f"{file} cannot be shown in a page; known: {', '.join(types)}")
    return f"data:{types[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"
