"""Properties of every step of the supervisor.

Random sequences from the start rarely reach critical states, so single steps are drawn from all possible states too.
"""

from collections.abc import Iterator
from dataclasses import fields, replace
from random import Random
from typing import NamedTuple, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import (
    MOVING_STAGES,
    POWERED_STAGES,
    Action,
    Event,
    Stage,
    SupervisorState,
)
from kinesic.hardware.supervisor.status import awaited_input
from kinesic.hardware.supervisor.transitions import step

from ...examples import examples

ALL_EVENTS: tuple[Event, ...] = get_args(Event)
ENERGISING_ACTIONS = {"arm", "adopt"}  # actions that enable torque
MOTION_ACTIONS = {"approach", "follow", "fold"}  # actions that move the robot
FRESH_STAGES = {Stage.PROBE, Stage.CONFIGURE, Stage.LIMP}  # stages without history
UNARMED_STAGES = {Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}  # stages in which torque may be incomplete
OBSERVED_FIELDS = [field.name for field in fields(Observation) if field.name != "policy"]
STATE_FIELDS = [field.name for field in fields(SupervisorState) if field.name != "stage"]
ALL_STAGES = list(Stage)
STEP_COUNT, STATE_COUNT = 30_000, 1_000
RELEASE_STAGES = {
    Stage.CLOSED,
    Stage.LIMP,
    Stage.RELEASE,
}  # stages in which the supervisor has decided to switch torque off


class TakenStep(NamedTuple):
    """Step of the state machine with its inputs and results."""

    before: SupervisorState
    event: Event
    known: Observation
    after: SupervisorState
    actions: tuple[Action, ...]


def possible(state: SupervisorState) -> SupervisorState:
    """Correct a random state so that the state satisfies the supervisor's invariants."""
    powered = state.stage in POWERED_STAGES
    if state.stage in FRESH_STAGES:
        state = replace(state, powered=False, armed=False, stopped=False, paused=False)
    return replace(
        state,
        checked=state.stage is not Stage.PROBE and (state.checked or state.stage is not Stage.CLOSED),
        powered=state.powered or powered,
        armed=state.armed or (powered and state.stage not in UNARMED_STAGES),
        paused=state.paused or state.stopped,
        faulty=state.faulty or state.refused,
    )


def drawn_flags(random: Random, names: list[str]) -> dict[str, bool]:
    bits = random.getrandbits(len(names))
    return {name: bool(bits >> k & 1) for k, name in enumerate(names)}


def drawn_state(random: Random) -> SupervisorState:
    remembered = drawn_flags(random, STATE_FIELDS)
    return possible(SupervisorState(random.choice(ALL_STAGES), **remembered))


def drawn_event(random: Random) -> Event:
    """Draw an event, or none in half of the cases."""
    return "tick" if random.random() < 0.5 else random.choice(ALL_EVENTS)


def drawn_facts(random: Random) -> Observation:
    known = drawn_flags(random, OBSERVED_FIELDS)
    return Observation(
        **known | {"raised": known["raised"] and known["energised"]}, policy=random.choice(("hold", "limp"))
    )


def dismissed(known: Observation) -> bool:
    """Return whether an emergency stop may end by switching torque off."""
    return known.release or known.confirmed or known.alone


def taken(before: SupervisorState, event: Event, known: Observation) -> TakenStep:
    return TakenStep(before, event, known, *step(before, event, known))


@pytest.fixture(scope="module")
def steps() -> list[TakenStep]:
    """Return random steps from all possible states."""
    random = Random(0)
    return [taken(drawn_state(random), drawn_event(random), drawn_facts(random)) for _ in range(STEP_COUNT)]


@pytest.fixture
def states() -> Iterator[SupervisorState]:
    random = Random(1)
    return (drawn_state(random) for _ in range(STATE_COUNT))


facts = st.builds(drawn_facts, st.randoms(use_true_random=False))


@given(st.lists(st.tuples(st.sampled_from(ALL_EVENTS), facts), max_size=25))
@examples(100)
def test_no_event_sequence_reaches_an_impossible_supervisor_state(story: list[tuple[Event, Observation]]):
    state = SupervisorState()
    for event, known in [("open", Observation()), *story]:
        state, _ = step(state, event, known)
        assert possible(state) == state


def test_supervisor_enables_no_torque_before_all_servos_are_checked(steps: list[TakenStep]):
    for before, _, _, after, actions in steps:
        if ENERGISING_ACTIONS & set(actions):
            assert before.checked
            assert after.powered
        if not after.checked:
            assert after.stage in (Stage.CLOSED, Stage.PROBE)
        if before.stage is Stage.PROBE:
            assert after.checked == (after.stage is Stage.CONFIGURE)


def test_supervisor_leaves_probe_and_configuration_only_when_done_or_closing(steps: list[TakenStep]):
    for before, event, _, after, _ in steps:
        if before.stage in (Stage.PROBE, Stage.CONFIGURE) and event not in ("done", "estop"):
            assert after.stage in (before.stage, Stage.CLOSED)


def test_emergency_stop_pauses_the_supervisor_in_every_state(steps: list[TakenStep]):
    for before, event, known, after, actions in steps:
        if event == "estop":
            assert after.stopped
            assert after.paused
            assert after.stage not in MOVING_STAGES | {Stage.HOLD}
            assert after.stage is not Stage.ARM or known.raised
            assert not (ENERGISING_ACTIONS | MOTION_ACTIONS) & set(actions)
            if known.policy == "limp":
                assert after.stage in (Stage.RELEASE, Stage.CLOSED)
            elif known.raised and before.stage is not Stage.RELEASE:
                assert "release" not in actions


def test_stopped_supervisor_neither_moves_the_robot_nor_enables_torque(steps: list[TakenStep]):
    """Check all steps between stopped states without motion or dismissal."""
    for before, _, known, after, actions in steps:
        if before.stopped and after.stopped and not dismissed(known) and before.stage not in MOVING_STAGES:
            assert not MOTION_ACTIONS & set(actions)
            assert "arm" not in actions
            assert after.stage not in MOVING_STAGES
            assert before.stage is not Stage.STOPPED or after.stage is not Stage.HOLD


def test_torque_is_enabled_only_on_arming_and_disabled_only_on_release(steps: list[TakenStep]):
    for _, _, _, after, actions in steps:
        assert ("arm" in actions) == (after.stage is Stage.ARM and bool(actions))
        assert ("release" in actions) == (after.stage is Stage.RELEASE and bool(actions))


def test_torque_of_raised_limbs_is_disabled_only_on_confirmation_or_a_torque_off_stop(steps: list[TakenStep]):
    for _, event, known, _, actions in steps:
        if "release" in actions and known.raised:
            assert known.confirmed or (event == "estop" and known.policy == "limp")


def test_no_state_continues_a_long_interrupted_performance_without_a_resume_request(steps: list[TakenStep]):
    for before, event, known, after, actions in steps:
        struck = known.interrupted and before.armed and before.stage in POWERED_STAGES
        if struck or (before.paused and event not in ("resumed", "open")):
            assert after.paused
            assert not {"approach", "follow"} & set(actions)
            assert after.stage not in (Stage.APPROACH, Stage.ACTIVE)
            assert "arm" not in actions or known.raised


def good_end(state: SupervisorState, known: Observation) -> SupervisorState:
    """Run the supervisor without further faults until its state is constant."""
    for _ in range(30):
        event: Event = "tick"
        if state.stage in (Stage.PROBE, Stage.CONFIGURE, Stage.ARM, Stage.IDENTIFY, Stage.ADOPT, Stage.RELEASE):
            event = "done"
        if state.stage is Stage.LOST:
            event = "back"
        after, actions = step(state, event, known)
        if after == state and not actions:
            return state
        state = after
    raise AssertionError(f"{state} changes for ever")


def test_every_state_reaches_the_closed_stage_after_the_planner_ends(states: Iterator[SupervisorState]):
    for number, state in enumerate(states):
        release = bool(number % 2)
        known = Observation(energised=True, reached=True, idle=True, ended=True, alone=not release, release=release)
        assert good_end(state, known).stage is Stage.CLOSED


def test_robot_with_raised_limbs_holds_its_posture_at_the_end_until_a_person_confirms(
    states: Iterator[SupervisorState],
):
    for number, state in enumerate(states):
        known = Observation(energised=True, reached=True, idle=True, ended=True, release=True, raised=True)
        known = replace(known, alone=bool(number % 2))
        end = good_end(state, known)
        assert end.stage is (Stage.CLOSED if state.stage in RELEASE_STAGES else Stage.WAITING)
        if end.stage is Stage.WAITING:
            assert awaited_input(end, well=True) == "confirmation"
            assert good_end(end, replace(known, confirmed=True)).stage is Stage.CLOSED


def test_robot_holds_and_then_moves_to_rest_if_the_planner_dies_during_an_emergency_stop(
    states: Iterator[SupervisorState],
):
    known = Observation(energised=True, raised=True, ended=True, alone=True)
    for before in states:
        state, _ = step(before, "estop", known)
        if state.stage is not Stage.STOPPED or state.careful:
            continue
        for _ in range(3):
            state, actions = step(state, "tick", known)
            assert set(actions) <= {"hold"}
        state, actions = step(state, "tick", replace(known, idle=True))
        assert actions == ("fold",)


def test_every_state_ends_in_a_safe_stage_that_states_the_awaited_input(states: Iterator[SupervisorState]):
    for state in states:
        end = good_end(state, Observation(energised=True, reached=True, idle=True))
        assert end.stage in (Stage.CLOSED, Stage.LIMP, Stage.STOPPED) or (end.stage is Stage.HOLD and end.folded)
        assert (awaited_input(end, well=True) == "nothing") == (end.stage is Stage.CLOSED)


def test_supervisor_closes_if_a_lost_port_is_unrecoverable(states: Iterator[SupervisorState]):
    for state in states:
        assert step(replace(state, stage=Stage.LOST), "tick", Observation(hopeless=True))[0].stage is Stage.CLOSED


def test_supervisor_state_machine_is_deterministic(steps: list[TakenStep]):
    for before, event, known, after, actions in steps[::10]:
        assert step(before, event, known) == (after, actions)
