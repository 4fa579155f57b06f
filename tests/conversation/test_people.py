"""Tracking of people and choice of the attended person."""

from dataclasses import replace
from itertools import pairwise

import pytest

from kinesic.conversation.events import PeopleSeen, Person
from kinesic.conversation.people import (
    GLANCE_DURATION,
    JUMP_DELAY,
    MAX_ABSENCE,
    MIN_SPELL,
    SWITCH_DELAY,
    Company,
    Roles,
    azimuth,
    choose_focus,
    is_near,
    next_check,
    observe,
)

EYES = (0.0, 0.0, 1.5)
NOBODY = Roles()
FRONT, LEFT, RIGHT = (1.5, 0.0, 1.5), (1.0, 1.0, 1.5), (1.0, -1.0, 1.5)


def seen(*people, age=0.0):
    return PeopleSeen(tuple(Person(id, place, looks) for id, place, looks in people), age)


def watch(people, reports, *, roles=NOBODY, since=0.0, period=0.1):
    """Report the same people several times.

    Returns the people and the time of the last report.
    """
    time = since
    for report in reports:
        people = choose_focus(observe(people, report, time, eyes=EYES), roles, time, eyes=EYES)
        time += period
    return people, time - period


def test_tracked_position_follows_a_moving_person_smoothly():
    still, time = watch(Company(), [seen(("a", FRONT, False))] * 5)
    assert still.tracked[0].place == pytest.approx(FRONT)
    moved = observe(still, seen(("a", (1.5, 0.3, 1.5), False)), time + 0.05, eyes=EYES)
    assert 0.05 < moved.tracked[0].place[1] < 0.15
    later, _ = watch(moved, [seen(("a", (1.5, 0.3, 1.5), False))] * 10, since=time + 0.1)
    assert later.tracked[0].place[1] == pytest.approx(0.3, abs=0.005)


def test_last_seen_time_of_a_person_is_the_time_of_the_measurement():
    people = observe(Company(), seen(("a", FRONT, False), age=0.4), 2.0, eyes=EYES)
    assert people.tracked[0].seen == pytest.approx(1.6)
    assert next_check(people, 2.0) == pytest.approx(1.6 + MAX_ABSENCE)


def test_jump_of_a_tracked_position_is_followed_only_if_it_persists():
    people, time = watch(Company(), [seen(("a", FRONT, False))] * 3)
    once = observe(people, seen(("a", LEFT, False)), time + 0.1, eyes=EYES)
    assert once.tracked[0].place == pytest.approx(FRONT)
    back = observe(once, seen(("a", FRONT, False)), time + 0.2, eyes=EYES)
    assert back.tracked[0].place == pytest.approx(FRONT)
    assert back.tracked[0].jump is None
    steady = observe(once, seen(("a", LEFT, False)), time + 0.11 + JUMP_DELAY, eyes=EYES)
    assert steady.tracked[0].place == pytest.approx(LEFT)


def test_lost_person_who_reappears_nearby_with_another_tracker_id_keeps_the_person_key():
    people, time = watch(Company(), [seen(("a", FRONT, False))] * 3)
    found = observe(people, seen(("b", (1.5, 0.2, 1.5), False)), time + 0.8, eyes=EYES)
    assert [(person.key, person.id) for person in found.tracked] == [("a", "b")]
    assert found.find("b") is found.find("a") is not None
    far = observe(people, seen(("b", (1.5, 0.5, 1.5), False)), time + 0.8, eyes=EYES)
    assert {person.key for person in far.tracked} == {"a", "b"}
    late = observe(people, seen(("b", (1.5, 0.2, 1.5), False)), time + MAX_ABSENCE + 0.1, eyes=EYES)
    assert "b" in {person.id for person in late.tracked}


def test_new_person_with_a_reused_tracker_id_gets_a_new_key():
    people, time = watch(Company(), [seen(("a", FRONT, False))] * 2)
    renamed = observe(people, seen(("b", FRONT, False)), time + 0.1, eyes=EYES)
    both = observe(renamed, seen(("b", FRONT, False), ("a", LEFT, False)), time + 0.2, eyes=EYES)
    assert [(person.key, person.id) for person in both.tracked] == [("a", "b"), ("a-2", "a")]


def test_tracked_person_without_reports_is_dropped_after_a_second():
    people, time = watch(Company(), [seen(("a", FRONT, False))] * 2)
    assert people.focus == "a"
    gone = observe(people, seen(), time + MAX_ABSENCE + 0.01, eyes=EYES)
    assert gone.tracked == ()
    assert choose_focus(gone, NOBODY, time + MAX_ABSENCE + 0.01, eyes=EYES).focus is None
    assert observe(people, seen(), time + MAX_ABSENCE - 0.01, eyes=EYES).tracked


def test_attention_moves_to_another_person_only_after_a_delay():
    two = seen(("a", LEFT, True), ("b", RIGHT, True))
    people, time = watch(Company(), [two] * 20)
    assert people.focus == "a"
    speaks = Roles(speaker="b")
    time += 0.1
    challenged = choose_focus(observe(people, two, time, eyes=EYES), speaks, time, eyes=EYES)
    assert (challenged.focus, challenged.challenger) == ("a", "b")
    early, _ = watch(challenged, [two], roles=speaks, since=time + SWITCH_DELAY - 0.05)
    assert early.focus == "a"
    switched, _ = watch(challenged, [two], roles=speaks, since=time + SWITCH_DELAY + 0.05)
    assert switched.focus == "b"


def test_attention_to_a_person_lasts_a_minimum_time():
    two, time, people = seen(("a", LEFT, True), ("b", RIGHT, True)), 0.0, Company()
    switches = []
    for number in range(100):
        roles = Roles(speaker="ab"[number // 5 % 2])  # voices alternate every 0.5 s
        after = choose_focus(observe(people, two, time, eyes=EYES), roles, time, eyes=EYES)
        if people.focus is not None and after.focus != people.focus:
            switches.append(time)
        people, time = after, time + 0.1
    assert len(switches) >= 2
    assert all(later - earlier >= MIN_SPELL for earlier, later in pairwise(switches))


def test_robot_glances_once_at_a_newcomer():
    people, time = watch(Company(), [seen(("a", LEFT, True))] * 20)
    both = seen(("a", LEFT, True), ("b", RIGHT, False))
    met, time = watch(people, [both] * 3, since=time + 0.1)
    assert met.target(time).key == "b"
    assert met.focus == "a"
    later, time = watch(met, [both] * 20, since=time + GLANCE_DURATION)
    assert later.target(time).key == "a"


def test_robot_ignores_people_who_are_too_close_behind_it_or_far_away():
    places = {"touching": (0.2, 0.0, 1.5), "behind": (-1.0, 0.2, 1.5), "far": (4.0, 0.0, 1.5), "front": FRONT}
    assert {name for name, place in places.items() if is_near(place, EYES)} == {"front"}
    people, _ = watch(Company(), [seen(*((name, place, True) for name, place in places.items()))] * 3)
    assert people.focus == "front"
    assert azimuth(LEFT, EYES) == pytest.approx(45.0)


def test_delay_before_attention_moves_begins_anew_if_the_other_person_falls_silent_meanwhile():
    report = seen(("a", LEFT, True), ("b", RIGHT, True))
    people, time = watch(Company(), [report] * 30, roles=Roles(speaker="a"))
    assert people.focus == "a"
    tried = int(0.8 * SWITCH_DELAY / 0.05)
    people, time = watch(people, [report] * tried, roles=Roles(speaker="b"), since=time + 0.05, period=0.05)
    people, time = watch(people, [report] * 2, roles=Roles(speaker="a"), since=time + 0.05, period=0.05)
    assert people.challenger is None
    people, time = watch(people, [report] * tried, roles=Roles(speaker="b"), since=time + 0.05, period=0.05)
    assert people.focus == "a"
    people, _ = watch(people, [report] * 40, roles=Roles(speaker="b"), since=time + 0.05)
    assert people.focus == "b"


def test_next_check_of_tracked_people_is_the_first_of_absence_attention_switch_and_end_of_a_glance():
    people = observe(Company(), seen(("a", LEFT, False), ("b", RIGHT, False)), 5.0, eyes=EYES)
    assert next_check(Company(), 5.0) == float("inf")
    assert next_check(people, 5.0) == pytest.approx(5.0 + MAX_ABSENCE)
    challenged = replace(people, challenger="b", challenger_since=5.1, focus_since=0.0)
    assert next_check(challenged, 5.1) == pytest.approx(min(5.1 + SWITCH_DELAY, 5.0 + MAX_ABSENCE))
    fresh = replace(challenged, challenger_since=5.0 - SWITCH_DELAY, focus_since=5.3 - MIN_SPELL)
    assert next_check(fresh, 5.1) == pytest.approx(5.3)
    glancing = replace(people, glance=("a", 5.2))
    assert [next_check(glancing, now) for now in (5.1, 5.2)] == pytest.approx([5.2, 5.0 + MAX_ABSENCE])
