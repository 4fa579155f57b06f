"""Gathers the files of the page: what is built from `client/`, the robot's body, and examples."""

from importlib.resources import files
from pathlib import Path

import msgspec

from kinesic.body.config import names_of
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import SECTORS
from kinesic.report.report import Json
from kinesic.report.scene import scene_data
from kinesic.serve.wire.pages import WebFile

PAGE, EXAMPLES = (Path(__file__).parent / name for name in ("page", "examples"))
GREETING = Path(str(files("kinesic"))) / "configs" / "bml" / "welcome.bml"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
JSON = "application/json"
START = "index.html"


def page_files(
    robot: Robot, lexicon: Lexicon, *, style: str = "neutral", document: str | None = None
) -> dict[str, WebFile]:
    """Gathers all that a browser may have, by its path.

    Args:
        robot: that is shown.
        lexicon: whose gestures are listed.
        style: in which the robot begins.
        document: the name of the one that the page opens first, in the server's folder; None: an example.
    """
    found = {f"/{path.name}": WebFile(TYPES[path.suffix], path.read_bytes()) for path in sorted(PAGE.iterdir())}
    found["/"] = found.pop(f"/{START}")
    about = {
        "robot": body_data(robot),
        "gestures": _gestures(lexicon),
        "styles": sorted(names_of("style"), key=lambda name: (name != style, name)),
        "examples": _examples(),
        "document": document,
    }
    found["/studio.json"] = WebFile(JSON, msgspec.json.encode(about))
    return found


def body_data(robot: Robot) -> dict[str, Json]:
    """Gathers what the page knows of the robot: its shapes, its hinges and their ranges, its hands and their space."""
    skeleton, neck = robot.skeleton, robot.chains.get("neck")
    return {
        **scene_data(robot),
        "name": robot.name,
        "hinges": list(skeleton.names),
        "names": [segment.name for segment in skeleton.segments],
        "rest": [round(float(angle), 4) for angle in skeleton.rest],
        "lower": [round(float(angle), 4) for angle in skeleton.lower],
        "upper": [round(float(angle), 4) for angle in skeleton.upper],
        "hands": {side: robot.arm(side).wrist for side in SIDES},
        "elbows": {side: robot.arm(side).elbow for side in SIDES},
        "neck": skeleton.segment(neck[0]) if neck and robot.joints("torso") else None,
        "eyes": _eyes(robot) if neck else None,
        "arm_length": round(robot.arm_length, 4),
        "sectors": {axis: dict(centres) for axis, centres in SECTORS.items()},
        "gesture_origin": [round(float(value), 4) for value in robot.gesture_origin],
    }


def _eyes(robot: Robot) -> Json:
    """The segment of the eyes, where they are in it, and where they look when they look ahead."""
    eyes = robot.sites["eyes"]
    place: list[Json] = [round(float(value), 4) for value in eyes.position]
    facing: list[Json] = [round(float(value), 4) for value in eyes.facing]
    return {"segment": robot.skeleton.segment(eyes.segment), "at": place, "facing": facing}


def _gestures(lexicon: Lexicon) -> list[Json]:
    """Id, category and meaning of every gesture."""
    return [
        {"id": form.id, "category": form.category, "says": sense.says}
        for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)
    ]


def _examples() -> list[Json]:
    """Name and text of every example, the greeting first."""
    paths = (GREETING, *sorted(EXAMPLES.glob("*.bml")))
    return [{"name": path.stem.lstrip("0123456789_"), "text": path.read_text(encoding="utf-8")} for path in paths]
