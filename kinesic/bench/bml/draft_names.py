"""Scenarios with draft and dialect spellings of sync points.

Each sync point must come at its requested time.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from kinesic.bench.bml.expectations import ExpectationVerdict
from kinesic.bench.bml.virtual_realizer import Realizer
from kinesic.planning.setup import Setup

SUITE_NAME = "draft_names"  # name of the suite in metrics
TIME_TOLERANCE = 0.1  # [s] allowed deviation of a sync point, as in the third-party scenarios
SCENARIO_TIMEOUT = 60.0  # [s] virtual time after which a scenario fails


@dataclass(frozen=True)
class DraftScenario:
    """Block with sync points of a BML draft and their expected times."""

    content: str  # content of <bml id="b">
    times: Mapping[str, float]  # "behaviour:sync" by BML 1.0's names -> block time [s]
    attributes: str = ""  # further attributes of <bml>
    strict: bool = False  # whether the block is read as a strict draft


_SPEECH_BML = (
    '<speech id="s" {}="1"><text>Hello there, my dear friend</text></speech><head id="h" lexeme="NOD" start="s:{}"/>'
)

DRAFT_SCENARIOS: Mapping[str, DraftScenario] = {
    "stroke_start": DraftScenario('<gesture id="g" type="beat" stroke_start="2.0"/>', {"g:strokeStart": 2.0}),
    "stroke-start": DraftScenario('<gesture id="g" type="beat" stroke-start="2.0"/>', {"g:strokeStart": 2.0}),
    "stroke_end": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke_start="2.0" stroke_end="3.0"/>',
        {"g:strokeStart": 2.0, "g:strokeEnd": 3.0},
    ),
    "stroke-end": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke-start="2" stroke-end="3"/>', {"g:strokeStart": 2.0, "g:strokeEnd": 3.0}
    ),
    "relax_start": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke="2.0" relax_start="3.5"/>', {"g:stroke": 2.0, "g:relax": 3.5}
    ),
    "relax-end": DraftScenario(
        '<head id="h" lexeme="NOD" stroke="1" relax-end="2.5"/>', {"h:stroke": 1.0, "h:end": 2.5}
    ),
    "relax_end": DraftScenario(
        '<head id="h" lexeme="TILT" stroke="1" relax_end="3"/>', {"h:stroke": 1.0, "h:end": 3.0}
    ),
    "preparation_end": DraftScenario('<gesture id="g" lexeme="beat" preparation_end="1.5"/>', {"g:ready": 1.5}),
    "ready_start": DraftScenario(
        '<gaze id="z" target="user" start="1" ready_start="2"/>', {"z:start": 1.0, "z:ready": 2.0}
    ),
    "retraction-start": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke="2" retraction-start="3"/>', {"g:stroke": 2.0, "g:relax": 3.0}
    ),
    "stroke_peak": DraftScenario('<head id="h" lexeme="NOD" STROKE_PEAK="1.2"/>', {"h:stroke": 1.2}),
    "attack-peak": DraftScenario(
        '<face id="f" lexeme="smile" start="1" attack-peak="1.4"/>', {"f:start": 1.0, "f:attackPeak": 1.4}
    ),
    "expressions": DraftScenario(
        "".join(
            f'<face id="f{k}" type="smile" stroke_start="{t}" stroke_end="{t + 2}"/>' for k, t in enumerate((0, 4, 8))
        ),
        {"f1:attackPeak": 4.0, "f2:attackPeak": 8.0},
        attributes=' agent="Amber"',
    ),
    "references": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke_start="2" stroke_end="2.6"/>'
        '<head id="h" lexeme="NOD" stroke-start="g:stroke_start+0.2"/>',
        {"g:strokeStart": 2.0, "h:strokeStart": 2.2},
    ),
    "references-end": DraftScenario(
        '<gesture id="g" lexeme="offer" stroke="2" relax_start="3"/><head id="h" lexeme="NOD" start="g:relax-start"/>',
        {"g:relax": 3.0, "h:start": 3.0},
    ),
    "capitals": DraftScenario('<GESTURE id="g" TYPE="beat" STROKE_START="2"/>', {"g:strokeStart": 2.0}),
    "speech-stroke_start": DraftScenario(_SPEECH_BML.format("start", "stroke_start"), {"s:start": 1.0, "h:start": 1.0}),
    "speech-ready": DraftScenario(_SPEECH_BML.format("start", "ready"), {"s:start": 1.0, "h:start": 1.0}),
    "strict": DraftScenario(
        '<gesture id="g" type="beat" stroke_start="2.0"/><head id="h" type="NOD" stroke="g:stroke_start"/>',
        {"g:strokeStart": 2.0, "h:stroke": 2.0},
        attributes=' xmlns="http://www.mindmakers.org/projects/BML"',
        strict=True,
    ),
}


def judge_draft_names(setup: Setup) -> Iterator[ExpectationVerdict]:
    """Play every draft-spelling scenario in virtual time and yield its verdict.

    Args:
        setup: robot, style and options.
    """
    for name, scenario in DRAFT_SCENARIOS.items():
        scenario_setup = replace(setup, dialect="draft") if scenario.strict else setup
        yield ExpectationVerdict(SUITE_NAME, name, judge_scenario(scenario, scenario_setup))


def judge_scenario(scenario: DraftScenario, setup: Setup) -> str:
    """Play a block and describe its sync points with wrong times.

    The result is empty if all are right.
    """
    realizer = Realizer(setup)
    realizer.send(f'<bml id="b"{scenario.attributes}>{scenario.content}</bml>')
    realizer.wait_until(lambda feedback: "b" in feedback.blocks("end"), timeout=SCENARIO_TIMEOUT)
    times = {sync: realizer.feedback.sync_time(f"b:{sync}") for sync in scenario.times}
    wrong = [
        f"{sync} {'never' if times[sync] is None else f'at {times[sync]:.3f} s'}, not at {time:g} s"
        for sync, time in scenario.times.items()
        if (actual := times[sync]) is None or abs(actual - time) > TIME_TOLERANCE
    ]
    return "; ".join(wrong)
