"""What holds for every step of the supervisor, wherever it is, whatever is known and whatever happens.

Stories from the beginning seldom come to where it matters: so many steps are drawn, from all states that may be.
"""

from collections.abc import Iterator
from dataclasses import fields, replace
from random import Random
from typing import NamedTuple, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import MOVING, POWERED, Action, Event, Stage, SupervisorState, step
from kinesic.hardware.supervisor.status import awaited

from ...examples import examples

EVENTS: tuple[Event, ...] = get_args(Event)
ENERGISING = {"arm", "adopt"}
GOING = {"approach", "follow", "fold"}
FRESH = {Stage.PROBE, Stage.CONFIGURE, Stage.LIMP}  # nothing has happened yet
UNARMED = {Stage.LOST, Stage.IDENTIFY, Stage.ARM, Stage.ADOPT}  # with torque that may not all have come yet
KNOWN = [field.name for field in fields(Observation) if field.name != "policy"]
REMEMBERED = [field.name for field in fields(SupervisorState) if field.name not in ("stage", "slowed")]
STEPS, STATES = 60_000, 2_000
DECIDED = {Stage.CLOSED, Stage.LIMP, Stage.RELEASE}  # whether torque is taken


class Taken(NamedTuple):
    """A step, with all that led to it."""

    before: SupervisorState
    event: Event
    known: Observation
    after: SupervisorState
    actions: tuple[Action, ...]


def possible(state: SupervisorState) -> SupervisorState:
    """The same with what always holds."""
    powered = state.stage in POWERED
    if state.stage in FRESH:
        state = replace(state, powered=False, armed=False, stopped=False, paused=False)
    return replace(
        state,
        checked=state.stage is not Stage.PROBE and (state.checked or state.stage is not Stage.CLOSED),
        powered=state.powered or powered,
        armed=state.armed or (powered and state.stage not in UNARMED),
        paused=state.paused or state.stopped,
        faulty=state.faulty or state.refused,
    )


def drawn_state(random: Random) -> SupervisorState:
    remembered = {name: random.random() < 0.5 for name in REMEMBERED}
    slowed = random.choice((Stage.APPROACH, Stage.ACTIVE))
    return possible(SupervisorState(random.choice(list(Stage)), slowed=slowed, **remembered))


def drawn_event(random: Random) -> Event:
    """Nothing in half of the cases, where facts alone decide."""
    return "tick" if random.random() < 0.5 else random.choice(EVENTS)


def drawn_facts(random: Random) -> Observation:
    known = {name: random.random() < 0.5 for name in KNOWN}
    return Observation(
        **known | {"raised": known["raised"] and known["energised"]}, policy=random.choice(("hold", "limp"))
    )


def taken(before: SupervisorState, event: Event, known: Observation) -> Taken:
    return Taken(before, event, known, *step(before, event, known))


@pytest.fixture(scope="module")
def steps() -> list[Taken]:
    """Many, from anywhere."""
    random = Random(0)
    return [taken(drawn_state(random), drawn_event(random), drawn_facts(random)) for _ in range(STEPS)]


@pytest.fixture
def states() -> Iterator[SupervisorState]:
    random = Random(1)
    return (drawn_state(random) for _ in range(STATES))


facts = st.builds(drawn_facts, st.randoms(use_true_random=False))


@given(st.lists(st.tuples(st.sampled_from(EVENTS), facts), max_size=25))
@examples(100)
def test_no_story_leads_to_what_is_called_impossible(story: list[tuple[Event, Observation]]):
    state = SupervisorState()
    for event, known in [("open", Observation()), *story]:
        state, _ = step(state, event, known)
        assert possible(state) == state


def test_nothing_is_energised_before_the_manifest_is_right(steps: list[Taken]):
    for before, _, _, after, actions in steps:
        if ENERGISING & set(actions):
            assert before.checked
            assert after.powered
        if not after.checked:
            assert after.stage in (Stage.CLOSED, Stage.PROBE)
        if before.stage is Stage.PROBE:
            assert after.checked == (after.stage is Stage.CONFIGURE)


def test_what_is_checked_waits_for_the_answer(steps: list[Taken]):
    for before, event, _, after, _ in steps:
        if before.stage in (Stage.PROBE, Stage.CONFIGURE) and event not in ("done", "estop"):
            assert after.stage in (before.stage, Stage.CLOSED)


def test_an_emergency_stop_wins(steps: list[Taken]):
    for before, event, known, after, actions in steps:
        if event == "estop":
            assert after.stopped
            assert after.paused
            assert after.stage not in MOVING | {Stage.HOLD}
            assert after.stage is not Stage.ARM or known.raised
            assert not (ENERGISING | GOING) & set(actions)
            if known.policy == "limp":
                assert after.stage in (Stage.RELEASE, Stage.CLOSED)
            elif known.raised and before.stage is not Stage.RELEASE:
                assert "release" not in actions


def test_nothing_moves_or_is_armed_after_an_emergency_stop(steps: list[Taken]):
    """Until somebody wants the end, or nobody is there who could."""
    for before, _, known, after, actions in steps:
        if before.stopped and after.stopped and not known.dismissed and before.stage not in MOVING:
            assert not GOING & set(actions)
            assert "arm" not in actions
            assert after.stage not in MOVING
            assert before.stage is not Stage.STOPPED or after.stage is not Stage.HOLD


def test_torque_comes_only_in_arm_and_goes_only_in_release(steps: list[Taken]):
    for _, _, _, after, actions in steps:
        assert ("arm" in actions) == (after.stage is Stage.ARM and bool(actions))
        assert ("release" in actions) == (after.stage is Stage.RELEASE and bool(actions))


def test_no_torque_is_taken_from_a_raised_limb_unless_a_person_wants_it(steps: list[Taken]):
    for _, event, known, _, actions in steps:
        if "release" in actions and known.raised:
            assert known.confirmed or (event == "estop" and known.policy == "limp")


def test_after_a_long_interruption_nothing_is_performed_without_consent(steps: list[Taken]):
    for before, event, known, after, actions in steps:
        struck = known.interrupted and before.armed and before.stage in POWERED
        if struck or (before.paused and event not in ("resumed", "open")):
            assert after.paused
            assert not {"approach", "follow"} & set(actions)
            assert after.stage not in (Stage.APPROACH, Stage.ACTIVE)
            assert "arm" not in actions or known.raised


def good_end(state: SupervisorState, known: Observation) -> SupervisorState:
    """Lets everything go well from now on, until nothing changes any more; where that is."""
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


def test_every_state_leads_to_release_once_the_planner_has_ended(states: Iterator[SupervisorState]):
    for number, state in enumerate(states):
        release = bool(number % 2)
        known = Observation(energised=True, reached=True, idle=True, ended=True, alone=not release, release=release)
        assert good_end(state, known).stage is Stage.CLOSED


def test_who_cannot_come_to_rest_is_held_until_a_person_confirms(states: Iterator[SupervisorState]):
    for number, state in enumerate(states):
        known = Observation(energised=True, reached=True, idle=True, ended=True, release=True, raised=True)
        known = replace(known, alone=bool(number % 2))
        end = good_end(state, known)
        assert end.stage is (Stage.CLOSED if state.stage in DECIDED else Stage.WAITING)
        if end.stage is Stage.WAITING:
            assert awaited(end, well=True) == "confirmation"
            assert good_end(end, replace(known, confirmed=True)).stage is Stage.CLOSED


def test_after_an_emergency_stop_a_dead_planner_means_hold_then_fold(states: Iterator[SupervisorState]):
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


def test_every_state_leads_to_rest_or_to_a_hold_that_says_what_it_waits_for(states: Iterator[SupervisorState]):
    for state in states:
        end = good_end(state, Observation(energised=True, reached=True, idle=True))
        assert end.stage in (Stage.CLOSED, Stage.LIMP, Stage.STOPPED) or (end.stage is Stage.HOLD and end.folded)
        assert (awaited(end, well=True) == "nothing") == (end.stage is Stage.CLOSED)


def test_a_lost_port_is_no_dead_end(states: Iterator[SupervisorState]):
    for state in states:
        assert step(replace(state, stage=Stage.LOST), "tick", Observation(hopeless=True))[0].stage is Stage.CLOSED


def test_the_machine_is_a_function(steps: list[Taken]):
    for before, event, known, after, actions in steps:
        assert step(before, event, known) == (after, actions)
