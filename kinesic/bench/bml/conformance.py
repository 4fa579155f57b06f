"""Plays scenarios of a conformance suite in virtual time: sends documents, checks feedback.

Targets that documents look or point at, and that the robot does not know, are put into a targets file of our own.
"""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, tostring

from kinesic.bench.bml.expectations import ExpectationVerdict, Scenario, Scenarios, Step
from kinesic.bench.bml.virtual_realizer import Feedback, Realizer, ReceivedMessage
from kinesic.bml.block import BmlError, Gaze, Gesture, HeadDirectionShift, Pointing
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.expressivity.context import read_targets
from kinesic.planning.setup import Setup

DRAFT = "draft"  # what suites in the draft's dialect begin with
NEAR = (1.5, 0.4, 1.2)  # [m] where a target is put that is nowhere else
APART = 0.1  # [m] from one to the next

Check = Callable[[Step, Feedback], str]


def play_suite(suite: str, where: Path, expected: Scenarios, setup: Setup) -> Iterator[ExpectationVerdict]:
    """Plays every scenario; its suite's name says which dialect it is in, and the draft's is read strictly.

    Args:
        suite: name of all of them.
        where: folder of the documents.
        expected: scenarios and what is expected.
        setup: of the robot that performs.
    """
    texts = [(where / name).read_bytes() for name, users in expected.documents.items() if users]
    known = replace(setup, targets={**setup.targets, **place_targets(texts, setup)})
    for name, scenario in expected.scenarios.items():
        dialect, _, test = name.partition("/")
        reads = replace(known, dialect="draft") if dialect.startswith(DRAFT) else known
        yield ExpectationVerdict(suite, f"{dialect}.{test}", _play(scenario, where, expected, reads))


def place_targets(texts: list[bytes], setup: Setup) -> Mapping[str, Floats]:
    """Gives targets that documents name and the robot has not a place in the world, (3,) [m], by a targets file."""
    names = sorted({name for text in texts for name in _targets(text)} - setup.robot.targets.keys())
    x, y, z = NEAR
    lines = [f'"{name}" = [{x}, {y - APART * k}, {z}]' for k, name in enumerate(names)]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "targets.toml"
        file.write_text("\n".join(lines), encoding="utf-8")
        return read_targets(file)


def _targets(text: bytes) -> Iterator[str]:
    try:
        behaviours = parse(text).behaviours
    except BmlError:
        return
    for behaviour in behaviours:
        action = behaviour.action
        if isinstance(action, Gaze | Gesture | HeadDirectionShift | Pointing) and action.target:
            yield action.target


def _play(scenario: Scenario, where: Path, expected: Scenarios, setup: Setup) -> str:
    """Why a scenario fails; empty when it passes."""
    realizer = Realizer(setup)
    for step in scenario.steps:
        why = _check(step, realizer.feedback) if step.check else _do(step, realizer, where, expected.timeout)
        if why:
            return why
    return ""


def _do(step: Step, realizer: Realizer, where: Path, timeout: float) -> str:
    match step.do:
        case "send":
            if step.inline_block is not None:
                realizer.send(tostring(Element("bml", step.inline_block)), source="<inline>")
            else:
                realizer.send((where / step.document).read_bytes(), source=step.document)
        case "sleep":
            realizer.wait(step.seconds)
        case "clear_feedback":
            realizer.feedback.messages.clear()
        case "wait_block_end":
            if not realizer.wait_until(lambda feedback: step.block in feedback.blocks("end"), timeout=timeout):
                return f"block {step.block} does not end within {timeout:g} s"
        case "wait_sync":
            if not realizer.wait_until(lambda feedback: feedback.sync_time(step.sync) is not None, timeout=timeout):
                return f"{step.sync} is not reported within {timeout:g} s"
        case _:
            return f"'{step.do}' is nothing that can be done"
    return ""


def _check(step: Step, feedback: Feedback) -> str:
    check = CHECKS.get(step.check)
    return f"'{step.check}' is no check" if check is None else check(step, feedback)


def _failures(feedback: Feedback) -> list[ReceivedMessage]:
    """Messages that something cannot be as asked; drafts call them exceptions, BML 1.0 warnings."""
    return feedback.of("warningFeedback")


def _none(step: Step, feedback: Feedback) -> str:
    found = _failures(feedback)
    said = "; ".join(f"{message.id}: {message.text}" for message in found)
    return "" if len(found) == step.count else f"{len(found)} {step.check}, not {step.count}: {said}"


def _duplicates(_: Step, feedback: Feedback) -> str:
    return "".join(f"reported more than once: {', '.join(again)}" for again in (feedback.repeated(),) if again)


def _blocks(step: Step, feedback: Feedback) -> str:
    for point, wanted in (("start", step.started), ("end", step.ended)):
        if feedback.blocks(point) != list(wanted):
            return f"{point} of blocks {feedback.blocks(point)}, not {list(wanted)}"
    return ""


def _order(step: Step, feedback: Feedback) -> str:
    found = feedback.syncs(step.behaviour)
    left = iter(found)
    missing = [sync for sync in step.syncs if sync not in left]
    return f"{step.behaviour}: {missing[0]} is missing, or out of order, in {found}" if missing else ""


def _time(step: Step, feedback: Feedback) -> str:
    found = feedback.sync_time(step.sync)
    if found is None:
        return f"{step.sync} was not reported"
    holds = {
        "sync_time": abs(found - step.time) <= (step.tolerance or 0.0),
        "sync_before_time": found < step.time,
        "sync_after_time": found > step.time,
    }[step.check]
    return "" if holds else f"{step.sync} at {found:.3f} s, {step.check} {step.time:g} s"


def _coincide(step: Step, feedback: Feedback) -> str:
    a, b = feedback.sync_time(step.a), feedback.sync_time(step.b)
    if a is None or b is None:
        return f"{step.a if a is None else step.b} was not reported"
    gap = abs(a + step.a_offset - b - step.b_offset)
    return "" if gap <= (step.tolerance or 0.0) else f"{step.a} and {step.b} are {gap:.3f} s apart"


def _succeeds(step: Step, feedback: Feedback) -> str:
    start, end = feedback.block_time(step.start_of, "start"), feedback.block_time(step.end_of, "end")
    if start is None or end is None:
        return f"start of {step.start_of} or end of {step.end_of} was not reported"
    gap = start - end
    return "" if abs(gap) <= (step.tolerance or 0.0) else f"{step.start_of} starts {gap:.3f} s after {step.end_of} ends"


def _lasts(step: Step, feedback: Feedback) -> str:
    start, end = feedback.block_time(step.block, "start"), feedback.block_time(step.block, "end")
    return "" if start is not None and end is not None and end > start else f"{step.block}: {start} to {end} s"


def _not_negative(_: Step, feedback: Feedback) -> str:
    early = [message.id for message in feedback.of("syncPointProgress") if message.time < 0.0]
    return f"before the start of their block: {', '.join(early)}" if early else ""


def _one_named(step: Step, feedback: Feedback) -> str:
    found = [message.id for message in _failures(feedback)]
    return "" if len(found) == 1 and found[0] in step.among else f"{found} named, not one of {list(step.among)}"


def _either(step: Step, feedback: Feedback) -> str:
    named = [message.id for message in _failures(feedback)]
    steps = (then for case in step.cases if case.when_named in named for then in case.then)
    return next(filter(None, (_check(then, feedback) for then in steps)), "")


CHECKS: Mapping[str, Check] = {
    "exceptions": _none,
    "warnings": _none,
    "no_duplicate_feedback": _duplicates,
    "blocks": _blocks,
    "sync_order": _order,
    "sync_time": _time,
    "sync_before_time": _time,
    "sync_after_time": _time,
    "syncs_coincide": _coincide,
    "block_starts_when_block_ends": _succeeds,
    "block_duration_positive": _lasts,
    "sync_times_not_negative": _not_negative,
    "one_behaviour_named": _one_named,
    "either": _either,
}
