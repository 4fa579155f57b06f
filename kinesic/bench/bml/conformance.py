"""Conformance scenarios in virtual time: send documents and check the feedback.

Targets that documents use but the robot lacks are defined in a generated targets file.
"""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, tostring

from kinesic.bench.bml.expectations import ExpectationVerdict, Scenario, ScenarioStep, ScenarioSuite
from kinesic.bench.bml.virtual_realizer import FeedbackLog, Realizer, ReceivedMessage
from kinesic.bml.block import BmlError, Gaze, Gesture, HeadDirectionShift, Pointing
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.expressivity.context import read_targets
from kinesic.planning.setup import Setup

DRAFT_PREFIX = "draft"  # prefix of scenario dialects that are read strictly as BML drafts
FIRST_TARGET = (1.5, 0.4, 1.2)  # [m] world position of the first generated target
TARGET_SPACING = 0.1  # [m] distance from one generated target to the next, to the right

Check = Callable[[ScenarioStep, FeedbackLog], str]


def play_suite(suite: str, folder: Path, expected: ScenarioSuite, setup: Setup) -> Iterator[ExpectationVerdict]:
    """Play every scenario and yield its verdict.

    The scenario's name contains its dialect; drafts are read strictly.

    Args:
        suite: name of the suite.
        folder: folder of the documents.
        expected: scenarios with their expectations.
        setup: robot, style and options.
    """
    texts = [(folder / name).read_bytes() for name, users in expected.documents.items() if users]
    extended_setup = replace(setup, targets={**setup.targets, **place_targets(texts, setup)})
    for name, scenario in expected.scenarios.items():
        dialect, _, test = name.partition("/")
        scenario_setup = (
            replace(extended_setup, dialect="draft") if dialect.startswith(DRAFT_PREFIX) else extended_setup
        )
        yield ExpectationVerdict(suite, f"{dialect}.{test}", _play(scenario, folder, expected, scenario_setup))


def place_targets(texts: list[bytes], setup: Setup) -> Mapping[str, Floats]:
    """Return generated world positions (3,) [m] of targets unknown to the robot.

    The targets named in the texts lie in a row. They are read from a generated targets file.
    """
    names = sorted({name for text in texts for name in _targets(text)} - setup.robot.targets.keys())
    x, y, z = FIRST_TARGET
    lines = [f'"{name}" = [{x}, {y - TARGET_SPACING * k}, {z}]' for k, name in enumerate(names)]
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


def _play(scenario: Scenario, folder: Path, expected: ScenarioSuite, setup: Setup) -> str:
    """Play a scenario and return the reason of its failure.

    The result is empty if it passes.
    """
    realizer = Realizer(setup)
    for step in scenario.steps:
        why = _check(step, realizer.feedback) if step.check else _do(step, realizer, folder, expected.timeout)
        if why:
            return why
    return ""


def _do(step: ScenarioStep, realizer: Realizer, folder: Path, timeout: float) -> str:
    match step.do:
        case "send":
            if step.inline_block is not None:
                realizer.send(tostring(Element("bml", step.inline_block)), source="<inline>")
            else:
                realizer.send((folder / step.document).read_bytes(), source=step.document)
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
            return f"'{step.do}' is not a known action"
    return ""


def _check(step: ScenarioStep, feedback: FeedbackLog) -> str:
    check = CHECK_FUNCTIONS.get(step.check)
    return f"'{step.check}' is not a known check" if check is None else check(step, feedback)


def _list_warnings(feedback: FeedbackLog) -> list[ReceivedMessage]:
    """Return the warnings in a feedback log (called exceptions in BML drafts)."""
    return feedback.of("warningFeedback")


def _check_count(step: ScenarioStep, feedback: FeedbackLog) -> str:
    warnings = _list_warnings(feedback)
    texts = "; ".join(f"{message.id}: {message.text}" for message in warnings)
    return "" if len(warnings) == step.count else f"{len(warnings)} {step.check}, not {step.count}: {texts}"


def _check_duplicates(_: ScenarioStep, feedback: FeedbackLog) -> str:
    return "".join(f"reported more than once: {', '.join(again)}" for again in (feedback.repeated(),) if again)


def _check_blocks(step: ScenarioStep, feedback: FeedbackLog) -> str:
    for point, expected in (("start", step.started), ("end", step.ended)):
        if feedback.blocks(point) != list(expected):
            return f"{point} of blocks {feedback.blocks(point)}, not {list(expected)}"
    return ""


def _check_order(step: ScenarioStep, feedback: FeedbackLog) -> str:
    reported = feedback.syncs(step.behaviour)
    remaining = iter(reported)
    missing = [sync for sync in step.syncs if sync not in remaining]
    return f"{step.behaviour}: {missing[0]} is missing, or out of order, in {reported}" if missing else ""


def _check_time(step: ScenarioStep, feedback: FeedbackLog) -> str:
    time = feedback.sync_time(step.sync)
    if time is None:
        return f"{step.sync} was not reported"
    is_met = {
        "sync_time": abs(time - step.time) <= (step.tolerance or 0.0),
        "sync_before_time": time < step.time,
        "sync_after_time": time > step.time,
    }[step.check]
    return "" if is_met else f"{step.sync} at {time:.3f} s, {step.check} {step.time:g} s"


def _check_coincidence(step: ScenarioStep, feedback: FeedbackLog) -> str:
    a, b = feedback.sync_time(step.a), feedback.sync_time(step.b)
    if a is None or b is None:
        return f"{step.a if a is None else step.b} was not reported"
    gap = abs(a + step.a_offset - b - step.b_offset)
    return "" if gap <= (step.tolerance or 0.0) else f"{step.a} and {step.b} are {gap:.3f} s apart"


def _check_succession(step: ScenarioStep, feedback: FeedbackLog) -> str:
    start, end = feedback.block_time(step.start_of, "start"), feedback.block_time(step.end_of, "end")
    if start is None or end is None:
        return f"start of {step.start_of} or end of {step.end_of} was not reported"
    gap = start - end
    return "" if abs(gap) <= (step.tolerance or 0.0) else f"{step.start_of} starts {gap:.3f} s after {step.end_of} ends"


def _check_duration(step: ScenarioStep, feedback: FeedbackLog) -> str:
    start, end = feedback.block_time(step.block, "start"), feedback.block_time(step.block, "end")
    return "" if start is not None and end is not None and end > start else f"{step.block}: {start} to {end} s"


def _check_not_negative(_: ScenarioStep, feedback: FeedbackLog) -> str:
    early = [message.id for message in feedback.of("syncPointProgress") if message.time < 0.0]
    return f"before the start of their block: {', '.join(early)}" if early else ""


def _check_one_named(step: ScenarioStep, feedback: FeedbackLog) -> str:
    names = [message.id for message in _list_warnings(feedback)]
    return "" if len(names) == 1 and names[0] in step.among else f"{names} named, not one of {list(step.among)}"


def _check_alternatives(step: ScenarioStep, feedback: FeedbackLog) -> str:
    named = [message.id for message in _list_warnings(feedback)]
    steps = (then for case in step.cases if case.when_named in named for then in case.then)
    return next(filter(None, (_check(then, feedback) for then in steps)), "")


CHECK_FUNCTIONS: Mapping[str, Check] = {
    "exceptions": _check_count,
    "warnings": _check_count,
    "no_duplicate_feedback": _check_duplicates,
    "blocks": _check_blocks,
    "sync_order": _check_order,
    "sync_time": _check_time,
    "sync_before_time": _check_time,
    "sync_after_time": _check_time,
    "syncs_coincide": _check_coincidence,
    "block_starts_when_block_ends": _check_succession,
    "block_duration_positive": _check_duration,
    "sync_times_not_negative": _check_not_negative,
    "one_behaviour_named": _check_one_named,
    "either": _check_alternatives,
}
