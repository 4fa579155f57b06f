"""Preview and checks of a single gesture for its author."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.sax.saxutils import quoteattr

import numpy as np

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.body.config import CONFIGS, ConfigError, names_of
from kinesic.body.robot import SIDE_NAMES
from kinesic.expressivity.hands.appearance import StrokeAppearance, distinct, look, nearest
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import to_world
from kinesic.expressivity.style.pace import Pace
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.serve.desk.draft import Json, draft_json
from kinesic.serve.desk.reach import reach_posture

SINGLE_GESTURE_BML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="gesture"><gesture id="g" lexeme={} start="0.3"/></bml>'
)
TOML_ERROR_PATTERN = re.compile(r"\(?at line (\d+), column (\d+)\)?")  # location in messages of `tomllib`
MAX_REACH_ERROR = 0.02  # [m] distance of the hand from a key above which the key is reported


def gesture_text(lexeme: str, lexicon: Lexicon) -> str:
    """Return the TOML text of one built-in gesture.

    The text is that of `configs/gestures/`, with the category and without other gestures.

    Raises:
        ConfigError: there is no built-in gesture with this id.
    """
    form = lexicon.forms_by_id.get(lexeme)
    if form is None or form.category not in names_of(
        "gesture"
    ):  # the category becomes a file name, and gestuaries may name any category
        raise ConfigError(f"{lexeme}: there is no such built-in gesture; `kinesic gestures list` lists them")
    path = CONFIGS / "gestures" / f"{form.category}.toml"
    for part in re.split(r"^(?=\[)", path.read_text(encoding="utf-8"), flags=re.MULTILINE):
        if part.startswith("[[gesture]]") and f'\nid = "{lexeme}"\n' in part:
            return f'category = "{form.category}"\n\n{part.rstrip()}\n'
    raise ConfigError(f"{lexeme}: the gesture has no separate table")


def draft_gesture(toml: str, changes: tuple[str, ...], setup: Setup) -> dict[str, Json]:
    """Plan a TOML file's first gesture alone and return its preview.

    Args:
        toml: text of the file.
        changes: style changes as NAME=VALUE.
        setup: setup for planning.

    Returns:
        The answer to `gesture` as in docs/reference/wire-protocol.md; for a refused file, the error with its location.
    """
    try:
        (form, *_), lexicon = read_gesture_file(toml, setup)
        plan = plan_alone(form, replace(setup, lexicon=lexicon, style=setup.style.changed(changes)))
    except (BmlError, ConfigError) as error:
        return {"error": _error(str(error), toml)}
    table = tomllib.loads(toml)["gesture"][0]
    return {
        **draft_json(plan),
        "gesture": form.id,
        "keys": table["keys"],
        "times": [round(time, 4) for time in _key_times(plan, form)],
        "checks": list(_checks(plan, form)),
    }


def plan_alone(form: GestureForm, setup: Setup) -> Plan:
    """Plan a block with this gesture only.

    Raises:
        BmlError: the gesture cannot be planned.
    """
    return plan_block(parse(SINGLE_GESTURE_BML.format(quoteattr(form.id))), setup)


def read_gesture_file(toml: str, setup: Setup) -> tuple[tuple[GestureForm, ...], Lexicon]:
    """Return a file's gestures (at least one) and a lexicon with them.

    Raises:
        ConfigError: the file is invalid or has no gesture.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / "gesture.toml"
        path.write_text(toml, encoding="utf-8")
        try:
            lexicon = Lexicon.load(path)
        except ConfigError as error:
            raise ConfigError(str(error).replace(f"{path}: ", "").replace(str(path), "the file")) from None
    forms = lexicon.forms[: len(lexicon.forms) - len(Lexicon.load().forms)]
    if not forms:
        raise ConfigError("the file has no gesture; it needs a table [[gesture]] with id and keys")
    return forms, replace(lexicon, bodies=setup.lexicon.bodies)


def _key_times(plan: Plan, form: GestureForm) -> Sequence[float]:
    """Return approximate times of the stroke's keys [s after the first command]."""
    zero, at = plan.trajectory.zero, {sync.sync: sync.planned for sync in plan.syncs}
    if not at:
        return [0.0] * len(form.keys)
    first, last = at.get("strokeStart", at["start"]), at.get("strokeEnd", at["end"])
    if len(form.keys) == 1:
        return [zero + at.get("stroke", first)]
    times: list[float] = np.linspace(zero + first, zero + last, len(form.keys)).tolist()
    return times


def _checks(plan: Plan, form: GestureForm) -> list[Mapping[str, Json]]:
    """Check reach, clearance and distinctness of a gesture, and report its duration."""
    robot, rest = plan.setup.robot, plan.setup.robot.skeleton.rest
    clearance = float(plan.clearance.distances.min())
    checks: list[Mapping[str, Json]] = []
    for number, key in enumerate(form.keys, 1):
        for side, pose in key.hands.items():
            target = to_world(robot, side, pose.position)
            error = reach_posture(robot, plan.setup.distances, side, target, rest).residual
            if error > MAX_REACH_ERROR:
                what = f"pose {number}: the {SIDE_NAMES[side]} hand stays {100 * error:.0f} cm short of its place"
                checks.append({"name": "reach", "ok": False, "text": what})
    if not checks:
        checks.append({"name": "reach", "ok": True, "text": "the hands reach every pose"})
    text = f"{1000 * clearance:.0f} mm remain between hands, arms and body"
    checks.append({"name": "clearance", "ok": clearance >= robot.min_clearance, "text": text})
    checks.append(_check_distinct(plan.setup, form))
    checks.append({"name": "duration", "ok": True, "text": f"it lasts {plan.duration:.1f} s, from rest to rest"})
    return checks


def _check_distinct(setup: Setup, form: GestureForm) -> Mapping[str, Json]:
    """Check that the gesture looks different from all built-in gestures."""
    appearance = look(form, setup.pace)
    others = {name: other for name, other in _stroke_appearances(setup.pace).items() if name != form.id}
    similar = next((name for name, other in others.items() if not distinct(appearance, other)), None)
    if similar is not None:
        text = f"it looks like {similar}: the hands have the same paths, directions and shapes"
        return {"name": "distinct", "ok": False, "text": text}
    name, distance = nearest(appearance, others)
    return {
        "name": "distinct",
        "ok": True,
        "text": f"it looks unlike all other gestures; {name} is the most similar ({100 * distance:.0f} cm apart)",
    }


@lru_cache(maxsize=2)  # the style of the document, and the changed style of a gesture that is compared with it
def _stroke_appearances(pace: Pace) -> Mapping[str, StrokeAppearance]:
    """Return the sampled hand motion of each built-in gesture's stroke, by id.

    The first call takes a second.
    """
    return {form.id: look(form, pace) for form in Lexicon.load().forms}


def _error(text: str, toml: str) -> dict[str, Json]:
    """Return an error text with its line and column in the TOML."""
    match = TOML_ERROR_PATTERN.search(text)
    if match is not None:
        return {"line": int(match[1]), "column": int(match[2]), "text": text}
    before = toml.partition("[[gesture]]")[0]
    return {"line": before.count("\n") + 1, "column": 1, "text": text}
