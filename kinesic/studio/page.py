"""Files of the studio page.

The bundle of `client/`, data of the robot, and examples.
"""

from importlib.resources import files
from pathlib import Path

import msgspec

from kinesic.body.config import names_of
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import SECTOR_CENTRES
from kinesic.report.report import Json
from kinesic.report.scene import scene_data
from kinesic.serve.wire.pages import WebFile

PAGE_FOLDER = Path(__file__).parent / "page"  # folder of the page's files
EXAMPLE_FOLDER = Path(__file__).parent / "examples"  # folder of the example documents
TEMPLATE_FOLDER = Path(__file__).parent / "templates"  # folder of the BML templates for new documents
WELCOME_EXAMPLE = Path(str(files("kinesic"))) / "configs" / "bml" / "welcome.bml"  # first example, opened by default
JSON_TYPE = "application/json"  # MIME type of JSON
CONTENT_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": JSON_TYPE,
}
START_FILE = "index.html"  # file served at the root of the site


def page_files(
    robot: Robot, lexicon: Lexicon, *, style: str = "neutral", document: str | None = None
) -> dict[str, WebFile]:
    """Return all files of the studio page by URL path.

    Args:
        robot: robot on the stage.
        lexicon: lexicon of the listed gestures.
        style: initial style of the robot.
        document: name of the first opened document in the server's folder; None: an example.
    """
    contents = {
        f"/{path.name}": WebFile(CONTENT_TYPES[path.suffix], path.read_bytes())
        for path in sorted(PAGE_FOLDER.iterdir())
    }
    contents["/"] = contents.pop(f"/{START_FILE}")
    about = {
        "robot": body_data(robot),
        "gestures": _list_gestures(lexicon),
        "styles": sorted(names_of("style"), key=lambda name: (name != style, name)),
        "examples": _list_documents(WELCOME_EXAMPLE, *sorted(EXAMPLE_FOLDER.glob("*.bml"))),
        "templates": _list_documents(*sorted(TEMPLATE_FOLDER.glob("*.bml"))),
        "document": document,
    }
    contents["/studio.json"] = WebFile(JSON_TYPE, msgspec.json.encode(about))
    return contents


def body_data(robot: Robot) -> dict[str, Json]:
    """Return shapes, joints, hands and gesture space of a robot as JSON."""
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
        "eyes": _locate_eyes(robot) if neck else None,
        "arm_length": round(robot.arm_length, 4),
        "sectors": {axis: dict(centres) for axis, centres in SECTOR_CENTRES.items()},
        "gesture_origin": [round(float(value), 4) for value in robot.gesture_origin],
    }


def _locate_eyes(robot: Robot) -> Json:
    """Return segment, position and forward direction of the robot's eyes."""
    eyes = robot.sites["eyes"]
    place: list[Json] = [round(float(value), 4) for value in eyes.position]
    facing: list[Json] = [round(float(value), 4) for value in eyes.facing]
    return {"segment": robot.skeleton.segment(eyes.segment), "at": place, "facing": facing}


def _list_gestures(lexicon: Lexicon) -> list[Json]:
    """List id, category and meaning of every gesture."""
    return [
        {"id": form.id, "category": form.category, "says": sense.says}
        for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)
    ]


def _list_documents(*paths: Path) -> list[Json]:
    """List name and text of documents, names without leading sort numbers."""
    return [{"name": path.stem.lstrip("0123456789_"), "text": path.read_text(encoding="utf-8")} for path in paths]
