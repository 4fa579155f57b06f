"""Dry run of a document: times, deviations and stroke picture."""

from asyncio import to_thread
from base64 import b64decode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, cast

import numpy as np

from kinesic.mcp.call_queue import CallQueue
from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.document_schema import Json
from kinesic.mcp.performing import check_document, list_deviations, refuse_errors
from kinesic.mcp.robot_gate import RobotGate

if TYPE_CHECKING:
    from kinesic.mcp.stroke_picture import StrokeFigure

MAX_PREVIEWS = 8  # largest number of pending previews
MAX_FIGURES = 8  # largest number of robot figures, one per stroke, in a picture
TIME_DIGITS = 2  # decimal places of the times [s] in a preview
HAND_TYPES = ("gesture", "pointing", "grasp")  # behaviour types whose strokes are preferred in the picture
NO_PICTURE_NOTE = "no picture: no behaviour has a stroke"


@dataclass(frozen=True)
class PlanPreview:
    """Answer and stroke picture of a dry run."""

    answer: RobotAnswer
    picture: bytes | None  # PNG file of the robot at the strokes, if it could be drawn


class Previewer:
    """Executor of dry runs, independent of the documents being performed."""

    def __init__(self, gate: RobotGate) -> None:
        """Create an executor for a robot that may still be starting."""
        self._gate = gate
        self._calls = CallQueue(max_calls=MAX_PREVIEWS)

    async def preview(self, write: Callable[[], str]) -> PlanPreview:
        """Plan a document without performing it, and draw its strokes.

        Args:
            write: creates the document, in a separate thread.

        Raises:
            RefusedError: the document is invalid, or too many calls are pending.
            RobotError: there is no answer in time.
        """
        return await self._calls.run(partial(self._preview_in_turn, write))

    async def _preview_in_turn(self, write: Callable[[], str]) -> PlanPreview:
        line = await self._gate.ready_line()
        async with self._calls.turn():
            document, _ = await to_thread(check_document, write)
            planned = await line.previews.ask("plan", bml=document)
            refuse_errors(planned, document)
            status = await line.status()
            return await to_thread(self._make, planned, status)

    def _make(self, planned: RobotAnswer, status: RobotAnswer) -> PlanPreview:
        from kinesic.mcp.stroke_picture import draw_strokes  # noqa: PLC0415 - slow to import, and not needed to start

        answer, robot = summarise_plan(planned), self._gate.setup.result().robot
        if status.get("robot") != robot.name:
            return PlanPreview({**answer, "picture": "no picture: the server performs with another robot"}, None)
        figures, total = choose_figures(planned, len(robot.skeleton.rest))
        if not figures:
            return PlanPreview({**answer, "picture": NO_PICTURE_NOTE}, None)
        shown = f"{total}" if len(figures) == total else f"{len(figures)} of {total}"
        note = f"{shown} stroke{'s' if total > 1 else ''}"
        return PlanPreview({**answer, "picture": note}, draw_strokes(robot, figures))


def summarise_plan(planned: RobotAnswer) -> RobotAnswer:
    """Return duration, times of behaviours [s from the start] and deviations."""
    syncs = _syncs(planned)
    behaviours: list[Json] = []
    for behaviour in _dicts(planned, "behaviours"):
        times = {str(sync["sync"]): sync for sync in syncs if sync["behaviour"] == behaviour["id"]}
        entry: dict[str, Json] = {"id": behaviour["id"], "type": behaviour["type"]}
        if behaviour["outcome"] == "dropped":
            entry["dropped"] = behaviour["why"]
        entry |= {name: _rounded(times[name]["planned"]) for name in _shown_points(behaviour) if name in times}
        behaviours.append(entry)
    answer: dict[str, Json] = {"seconds": _rounded(planned["duration"]), "behaviours": behaviours}
    return {**answer, "not_as_asked": list_deviations(planned)}


def choose_figures(planned: RobotAnswer, hinges: int) -> "tuple[list[StrokeFigure], int]":
    """Return the stroke postures to draw, and the number of strokes.

    If hands have strokes, all others are omitted.

    Args:
        planned: the server's answer to `plan`.
        hinges: number of hinges of the robot.
    """
    from kinesic.mcp.stroke_picture import StrokeFigure  # noqa: PLC0415 - slow to import, and not needed to start

    types = {str(each["id"]): str(each["type"]) for each in _dicts(planned, "behaviours")}
    strokes = [
        sync for sync in _syncs(planned) if sync["sync"] == "stroke" and types[str(sync["behaviour"])] != "speech"
    ]
    of_hands = [sync for sync in strokes if types[str(sync["behaviour"])] in HAND_TYPES]
    chosen = sorted(of_hands or strokes, key=lambda sync: cast(float, sync["planned"]))
    total = len(chosen)
    if total > MAX_FIGURES:
        chosen = [chosen[round(k * (total - 1) / (MAX_FIGURES - 1))] for k in range(MAX_FIGURES)]
    rate = cast(float, planned["rate"])
    rows = np.frombuffer(b64decode(str(planned["angles"])), "<f4").astype(np.float64).reshape(-1, hinges)
    words = _dicts(planned, "words")
    figures = []
    for sync in chosen:
        time = cast(float, sync["planned"])
        spoken = next((str(word["text"]) for word in words if _contains(word, time)), "")
        row = rows[min(round(time * rate), len(rows) - 1)]
        figures.append(StrokeFigure(row, f"{sync['behaviour']}  {time:.2f} s", spoken.strip()))
    return figures, total


def _shown_points(behaviour: Mapping[str, Json]) -> tuple[str, ...]:
    return ("start", "end") if behaviour["type"] == "speech" else ("start", "stroke", "end")


def _contains(words: Mapping[str, Json], time: float) -> bool:
    return cast(float, words["start"]) <= time < cast(float, words["end"])


def _syncs(planned: RobotAnswer) -> Sequence[Mapping[str, Json]]:
    return _dicts(planned, "syncs")


def _dicts(planned: RobotAnswer, key: str) -> Sequence[Mapping[str, Json]]:
    return cast(Sequence[Mapping[str, Json]], planned[key])


def _rounded(seconds: Json) -> float:
    return round(cast(float, seconds), TIME_DIGITS)
