from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import Event, Stage
from kinesic.hardware.supervisor.transitions import (
    FLAG_RULES,
    INPUT_NAMES,
    TRANSITION_TABLE,
    FlagRule,
    Transition,
    step,
)

from .supervisor_model import Case, SupervisorModel, broken_rules, nodes_without_end

BENCHMARK_PAGE = Path(__file__).resolve().parents[3] / "docs" / "benchmarks" / "proof.md"

Table = tuple[Sequence[Transition], Sequence[FlagRule]]


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    """Return every transition between reachable states."""
    return list(SupervisorModel().explore())


def observation(inputs: Sequence[str], number: int) -> Observation:
    """Return the observation of one bit of a truth table."""
    values = {name: bool(number >> place & 1) for place, name in enumerate(inputs)}
    policy = "limp" if values.pop("limp_policy", False) else "hold"
    others = {name: False for name in INPUT_NAMES if name not in inputs and name != "limp_policy"}
    return Observation(policy=policy, **(values | others))


def test_every_reachable_state_of_the_supervisor_keeps_all_safety_rules(cases: list[Case]):
    assert {rule for case in cases for rule in broken_rules(case)} == set()
    assert nodes_without_end(cases) == set()


def test_benchmark_page_states_the_size_of_the_supervisor_model(cases: list[Case]):
    nodes = {case.before for case in cases}
    page = BENCHMARK_PAGE.read_text(encoding="utf-8")
    rows = {
        "states of the supervisor": len({node.state for node in nodes}),
        "states with the memory of the model": len(nodes),
        "transitions": len(cases),
        "combinations of state, event and observation": sum(case.table.bit_count() for case in cases),
    }
    assert {node.state.stage for node in nodes} == set(Stage)
    assert [name for name, count in rows.items() if f"| {name} | {count} |" not in page] == []


def test_supervisor_model_and_step_function_agree_on_random_cases(cases: list[Case]):
    random = Random(0)
    for case in random.sample(cases, 2000):
        numbers = [number for number in random.sample(range(1 << len(case.inputs)), 8) if case.table >> number & 1]
        known = observation(case.inputs, (numbers or [case.table.bit_length() - 1])[0])
        assert step(case.before.state, case.event, known) == (case.after.state, case.actions)


def without_condition(stage: Stage, condition: str) -> Table:
    """Return the table without a condition in a stage's rows."""
    return [
        replace(row, when=tuple(name for name in row.when if name != condition)) if stage in row.stages else row
        for row in TRANSITION_TABLE
    ], FLAG_RULES


def without_rule(flag: str, event: Event) -> Table:
    """Return the table in which an event no longer changes a flag."""
    return TRANSITION_TABLE, [
        replace(rule, events=rule.events - {event}) if flag in rule.sets else rule for rule in FLAG_RULES
    ]


@pytest.mark.parametrize(
    ("table", "rule"),
    [
        (without_condition(Stage.WAITING, "may_release"), "raised limbs keep their torque"),
        (without_condition(Stage.HOLD, "not paused"), "motion continues only on request"),
        (without_condition(Stage.ARM, "not raised"), "raised limbs keep their torque"),
        (without_rule("paused", "tick"), "motion continues only on request"),
        (without_rule("stopped", "estop"), "nothing moves after a stop"),
        (without_rule("faulty", "failed"), "no performance after a failure"),
    ],
)
def test_model_check_of_the_supervisor_detects_a_weakened_transition_table(table: Table, rule: str):
    assert any(rule in broken_rules(case) for case in SupervisorModel(*table).explore())
