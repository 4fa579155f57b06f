"""Replacement of lexicon gestures by captured gestures of the same meaning."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.capture.graph_search import ClipChoice, GestureRequest, search_path
from kinesic.capture.motion_graph import MotionGraph, build_graph
from kinesic.expressivity.lexicon.captured_gesture import GestureCapture
from kinesic.expressivity.lexicon.space import to_gesture_space
from kinesic.expressivity.lexicon.synonyms import POINTING_CATEGORY
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.pacing.memory import PastGesture
from kinesic.planning.setup import Setup

CAPTURED_CATEGORIES = frozenset({"beat", "deictic", "metaphoric"})  # lexicon categories that clips may replace
MAX_POINTING = 8  # largest number of clips compared for one pointing gesture
MAX_TURN = float(np.radians(60.0))  # [rad] largest turn of a captured stroke towards a target
MAX_WRIST_BEND = float(np.radians(50.0))  # [rad] largest angle between arm and hand of a clip that points
MAX_CANDIDATES = 60  # largest number of clips compared for one gesture


def prefer_captured(
    behaviours: Sequence[ChosenBehaviour], earlier: Sequence[PastGesture] = (), *, setup: Setup
) -> tuple[ChosenBehaviour, ...]:
    """Replace beats, offers and deictics by captured gestures of the same meaning.

    The reason of a replaced gesture names the clip and the distance of its transition.

    Args:
        behaviours: of a text, in the order of their strokes.
        earlier: captured gestures before the text, on the clock of its behaviours, in the order of their strokes.
        setup: lexicon with captured gestures, style, robot and targets.
    """
    lexicon = setup.lexicon
    places = [k for k, behaviour in enumerate(behaviours) if behaviour.channel == "gesture"]
    requests = [
        GestureRequest(behaviours[k].intent.stroke.seconds, _find_candidates(behaviours[k], setup)) for k in places
    ]
    if not any(request.candidates for request in requests):
        return tuple(behaviours)
    graph = graph_of(lexicon.captured)
    manner = setup.style.of("gesture")
    numbers = {capture.id: k for k, capture in enumerate(graph.captures)}
    past = [
        GestureRequest(clip.seconds, (numbers[name],)) for clip in earlier if (name := clip.form.split()[0]) in numbers
    ]
    choices = search_path(graph, requests, pace=(manner.temporal + manner.power) / 2.0, earlier=past)
    chosen = list(behaviours)
    for k, choice in zip(places, choices, strict=True):
        if choice is not None:
            chosen[k] = _substitute(behaviours[k], graph, choice)
    return tuple(chosen)


@lru_cache(maxsize=2)
def graph_of(captures: tuple[GestureCapture, ...]) -> MotionGraph:
    """Return the motion graph of captured gestures."""
    return build_graph(captures)


def _find_candidates(behaviour: ChosenBehaviour, setup: Setup) -> tuple[int, ...]:
    """Return the indices of captured gestures with a behaviour's meaning.

    Beats have a single meaning; other gestures need a clip that resembles the same gesture.
    """
    lexicon = setup.lexicon
    if behaviour.intent.target:
        return _find_pointing(behaviour, setup)
    match = lexicon.find(behaviour.lexeme)
    if match is None or match.form.category not in CAPTURED_CATEGORIES or match.form.rest:
        return ()
    is_beat = match.form.category == "beat"
    forms = lexicon.forms_by_id
    found = [
        k
        for k, capture in enumerate(lexicon.captured)
        if capture.table.like == match.form.id or (is_beat and forms[capture.id].category == "beat")
    ]
    return tuple(found[:MAX_CANDIDATES])


def _find_pointing(behaviour: ChosenBehaviour, setup: Setup) -> tuple[int, ...]:
    """Return captured gestures whose hand points nearly at a target, nearest first."""
    place = {**setup.robot.targets, **setup.targets}.get(behaviour.intent.target)
    if place is None:
        return ()
    side: Side = "l" if place[1] > 0 else "r"
    shoulder = to_gesture_space(
        setup.robot, side, setup.robot.skeleton.rest_frames.origins[setup.robot.arm(side).shoulder]
    )
    line = to_gesture_space(setup.robot, side, place) - shoulder
    angles = {}
    for k, capture in enumerate(setup.lexicon.captured):
        form = setup.lexicon.forms_by_id[capture.id]
        if form.category != POINTING_CATEGORY or len(form.sides) != 1:
            continue
        pose = next(iter(form.keys[len(form.keys) // 2].hands.values()))
        arm = pose.position - shoulder
        if pose.pointing is not None and _angle(pose.pointing, arm) <= MAX_WRIST_BEND:
            angles[k] = _angle(arm, line)
    near = sorted((k for k in angles if angles[k] <= MAX_TURN), key=lambda k: (angles[k], k))
    return tuple(near[:MAX_POINTING])


def _angle(first: Floats, second: Floats) -> float:
    """Return the angle between two vectors (3,) [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second))


def _substitute(behaviour: ChosenBehaviour, graph: MotionGraph, choice: ClipChoice) -> ChosenBehaviour:
    capture = graph.captures[choice.capture]
    joined = f"transition {choice.distance:.2f} arm lengths" if choice.distance else "from rest"
    licence = f", {capture.table.licence}" if capture.table.licence else ""
    replaced = behaviour.lexeme or "pointing"
    why = f"{behaviour.intent.reason}; captured {capture.id} in place of {replaced}, {joined}{licence}"
    return replace(behaviour, lexeme=capture.id, captured=True, intent=replace(behaviour.intent, reason=why))
