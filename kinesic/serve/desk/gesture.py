"""Checks a gesture that is being written: what it would look like alone, and whether this body can make it."""

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
from kinesic.serve.desk.draft import Json, draft_of
from kinesic.serve.desk.reach import reach_posture

ALONE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="gesture"><gesture id="g" lexeme={} start="0.3"/></bml>'
)
PLACE = re.compile(r"\(?at line (\d+), column (\d+)\)?")
SHORT = 0.02  # [m] from which a key that the hand misses is told


def gesture_text(lexeme: str, lexicon: Lexicon) -> str:
    """Writes the file that holds one of our own gestures alone, as it stands in `configs/gestures/`.

    Raises:
        ConfigError: no file there has such a gesture.
    """
    form = lexicon.forms_by_id.get(lexeme)
    if form is None or form.category not in names_of("gesture"):  # never a path: gestuaries name any category
        raise ConfigError(f"{lexeme}: there is no such gesture of our own; `kinesic gestures list` lists them")
    path = CONFIGS / "gestures" / f"{form.category}.toml"
    for part in re.split(r"^(?=\[)", path.read_text(encoding="utf-8"), flags=re.MULTILINE):
        if part.startswith("[[gesture]]") and f'\nid = "{lexeme}"\n' in part:
            return f'category = "{form.category}"\n\n{part.rstrip()}\n'
    raise ConfigError(f"{lexeme}: it has no table of its own")


def draft_gesture(toml: str, changes: tuple[str, ...], setup: Setup) -> dict[str, Json]:
    """Plans the first gesture of a file alone.

    Args:
        toml: the file.
        changes: NAME=VALUE of the style.
        setup: what it is planned with.

    Returns:
        What docs/serve.md says of `gesture`; for a file that is refused, the error and its place.
    """
    try:
        (form, *_), lexicon = read_gesture_file(toml, setup)
        planned = plan_alone(form, replace(setup, lexicon=lexicon, style=setup.style.changed(changes)))
    except (BmlError, ConfigError) as error:
        return {"error": _error(str(error), toml)}
    table = tomllib.loads(toml)["gesture"][0]
    return {
        **draft_of(planned),
        "gesture": form.id,
        "keys": table["keys"],
        "times": [round(time, 4) for time in _key_times(planned, form)],
        "checks": list(_checks(planned, form)),
    }


def plan_alone(form: GestureForm, known: Setup) -> Plan:
    """Plans a gesture that nothing else goes with.

    Raises:
        BmlError: it cannot be planned.
    """
    return plan_block(parse(ALONE.format(quoteattr(form.id))), known)


def read_gesture_file(toml: str, setup: Setup) -> tuple[tuple[GestureForm, ...], Lexicon]:
    """Reads a file of gestures: its gestures, of which there is at least one, and a lexicon with them.

    Raises:
        ConfigError: it is wrong, or has no gesture.
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


def _key_times(planned: Plan, form: GestureForm) -> Sequence[float]:
    """[s] of the performance at which the keys of the stroke are passed, about."""
    zero, at = planned.trajectory.zero, {sync.sync: sync.planned for sync in planned.syncs}
    if not at:
        return [0.0] * len(form.keys)
    first, last = at.get("strokeStart", at["start"]), at.get("strokeEnd", at["end"])
    if len(form.keys) == 1:
        return [zero + at.get("stroke", first)]
    found: list[float] = np.linspace(zero + first, zero + last, len(form.keys)).tolist()
    return found


def _checks(planned: Plan, form: GestureForm) -> list[Mapping[str, Json]]:
    """What a maker wants to know before others see it."""
    robot, rest = planned.setup.robot, planned.setup.robot.skeleton.rest
    least = float(planned.clearance.distances.min())
    checks: list[Mapping[str, Json]] = []
    for number, key in enumerate(form.keys, 1):
        for side, pose in key.hands.items():
            target = to_world(robot, side, pose.position)
            short = reach_posture(robot, planned.setup.distances, side, target, rest).residual
            if short > SHORT:
                what = f"key {number}: the {SIDE_NAMES[side]} hand stays {100 * short:.0f} cm short of its place"
                checks.append({"name": "reach", "ok": False, "text": what})
    if not checks:
        checks.append({"name": "reach", "ok": True, "text": "every key is within reach"})
    text = f"the body keeps {1000 * least:.0f} mm clear of itself"
    checks.append({"name": "clearance", "ok": least >= robot.least_clearance, "text": text})
    checks.append(_check_distinct(planned.setup, form))
    checks.append({"name": "duration", "ok": True, "text": f"{planned.duration:.1f} s from rest to rest"})
    return checks


def _check_distinct(setup: Setup, form: GestureForm) -> Mapping[str, Json]:
    """Whether others see another gesture than those that are known already."""
    seen = look(form, setup.pace)
    others = {name: other for name, other in _known_looks(setup.pace).items() if name != form.id}
    alike = next((name for name, other in others.items() if not distinct(seen, other)), None)
    if alike is not None:
        text = f"looks like {alike}: hands go the same way, turned and shaped alike"
        return {"name": "distinct", "ok": False, "text": text}
    name, way = nearest(seen, others)
    return {"name": "distinct", "ok": True, "text": f"like no other; the nearest is {name}, {100 * way:.0f} cm away"}


@lru_cache(maxsize=1)
def _known_looks(pace: Pace) -> Mapping[str, StrokeAppearance]:
    """What is seen of every gesture of our own; it takes a second, once."""
    return {form.id: look(form, pace) for form in Lexicon.load().forms}


def _error(text: str, toml: str) -> dict[str, Json]:
    """The place that the message names; else the line of the gesture."""
    found = PLACE.search(text)
    if found is not None:
        return {"line": int(found[1]), "column": int(found[2]), "text": text}
    before = toml.partition("[[gesture]]")[0]
    return {"line": before.count("\n") + 1, "column": 1, "text": text}
