"""Tracking of people and choice of the robot's focus of attention.

All functions are pure. Reports of a tracker are smoothed, sudden jumps must persist, and a person keeps the identity if
the tracker loses and finds the person under another id.
"""

from dataclasses import dataclass, replace
from math import atan2, degrees, dist, exp, hypot

from kinesic.conversation.events import PeopleSeen, Person, Place

SMOOTHING_TIME = 0.15  # [s] time constant of the low-pass filter on positions
MAX_ABSENCE = 1.0  # [s] time without a report after which a person counts as gone
SAME_PERSON_DISTANCE = 0.3  # [m] largest distance between a lost person and the same person under another id
JUMP_ANGLE = 20.0  # [deg] change of direction above which a new position must persist for `JUMP_DELAY`
JUMP_DELAY = 0.2  # [s] time for which a sudden new position must persist
MIN_DISTANCE = 0.4  # [m] smallest distance from the robot's eyes at which a person is looked at
MAX_DISTANCE = 3.0  # [m] largest distance from the robot's eyes at which a person is attended to
MAX_AZIMUTH = 110.0  # [deg] largest azimuth, to either side, at which a person is looked at
SPEAKER_SCORE = 1.0  # score of the person who speaks
ADDRESSEE_SCORE = 0.6  # score of the person with whom the robot exchanged the last turn
LOOK_SCORE = 0.3  # score of a person who looks at the robot
PROXIMITY_SCORE = 0.2  # score of a person at distance 0, decreasing to 0 at `MAX_DISTANCE`
SWITCH_LEAD = 0.3  # smallest lead in score with which another person gets the robot's attention
SWITCH_DELAY = 0.4  # [s] time for which another person's score must lead before the attention switches
MIN_SPELL = 1.2  # [s] shortest time of attention to one person
GLANCE_DURATION = 1.0  # [s] duration of the glance at a person who arrives


@dataclass(frozen=True)
class TrackedPerson:
    """Person with a smoothed position and a stable identity."""

    key: str  # first id of the person
    id: str  # current id of the tracker
    place: Place  # [m] smoothed position of the eyes
    looks: bool  # whether the person looks at the robot
    seen: float  # [s] time of the last report
    jump: tuple[Place, float] | None = None  # sudden new position, and the time [s] of its first report


@dataclass(frozen=True)
class Company:
    """All people around the robot, with the attended person."""

    tracked: tuple[TrackedPerson, ...] = ()
    focus: str | None = None  # key of the attended person
    focus_since: float = 0.0  # [s] time of the last change of `focus`
    challenger: str | None = None  # key of a person who leads by `SWITCH_LEAD`
    challenger_since: float = 0.0  # [s] time since which the challenger leads
    glance: tuple[str, float] | None = None  # key of a newly arrived person, and the end [s] of the glance

    def find(self, name: str | None) -> TrackedPerson | None:
        """Return a person by key or current id, or None."""
        return next((person for person in self.tracked if name is not None and name in (person.key, person.id)), None)

    def target(self, now: float) -> TrackedPerson | None:
        """Return the newcomer during a glance, otherwise the attended person."""
        if self.glance is not None and now < self.glance[1]:
            return self.find(self.glance[0]) or self.find(self.focus)
        return self.find(self.focus)


@dataclass(frozen=True)
class Roles:
    """Conversational roles of people, by key or id."""

    speaker: str | None = None  # person who speaks now
    addressee: str | None = None  # person of the last turn


def observe(people: Company, seen: PeopleSeen, now: float, *, eyes: Place) -> Company:
    """Update all tracked people from a report.

    Args:
        people: state before the report.
        seen: report of a tracker.
        now: time of the report's arrival [s].
        eyes: position of the robot's eyes [m].
    """
    time = now - seen.age
    left = list(people.tracked)
    matched: list[TrackedPerson] = []
    unknown: list[Person] = []
    for person in seen.people:
        known = next((item for item in left if item.id == person.id), None)
        if known is None:
            unknown.append(person)
            continue
        left.remove(known)
        matched.append(_follow(known, person, time, eyes))
    newcomers: list[TrackedPerson] = []
    for person in unknown:
        same = min(left, key=lambda item: dist(item.place, person.place), default=None)
        if same is not None and dist(same.place, person.place) <= SAME_PERSON_DISTANCE:
            left.remove(same)
            matched.append(_follow(replace(same, id=person.id), person, time, eyes))
        else:
            newcomers.append(TrackedPerson(_new_key(person.id, people), person.id, person.place, person.looks, time))
    updated = replace(people, tracked=(*matched, *newcomers, *left))
    arrivals = [person for person in newcomers if is_visible(person.place, eyes)]
    if arrivals and people.focus is not None:
        updated = replace(updated, glance=(arrivals[0].key, now + GLANCE_DURATION))
    return expire(updated, now)


def expire(people: Company, now: float) -> Company:
    """Remove people without a report for `MAX_ABSENCE`."""
    tracked = tuple(person for person in people.tracked if now - person.seen < MAX_ABSENCE)
    return people if len(tracked) == len(people.tracked) else replace(people, tracked=tracked)


def choose_focus(people: Company, roles: Roles, now: float, *, eyes: Place) -> Company:
    """Choose the attended person with hysteresis.

    Args:
        people: tracked people.
        roles: speaker and addressee.
        now: current time [s].
        eyes: position of the robot's eyes [m].
    """
    scores = {person.key: _score(person, roles, eyes) for person in people.tracked if is_near(person.place, eyes)}
    if not scores:
        return people if people.focus is None else replace(people, focus=None, focus_since=now, challenger=None)
    best = max(scores, key=lambda key: scores[key])
    if people.focus not in scores:
        return replace(people, focus=best, focus_since=now, challenger=None)
    if scores[best] - scores[people.focus] < SWITCH_LEAD:
        return people if people.challenger is None else replace(people, challenger=None)
    if people.challenger != best:
        return replace(people, challenger=best, challenger_since=now)
    if now - people.challenger_since < SWITCH_DELAY or now - people.focus_since < MIN_SPELL:
        return people
    return replace(people, focus=best, focus_since=now, challenger=None)


def next_check(people: Company, now: float) -> float:
    """Return the earliest time [s] of a change by `expire` or `choose_focus`.

    Infinity if there is none.
    """
    times = [person.seen + MAX_ABSENCE for person in people.tracked]
    if people.challenger is not None:
        times.append(max(people.challenger_since + SWITCH_DELAY, people.focus_since + MIN_SPELL))
    if people.glance is not None and people.glance[1] > now:
        times.append(people.glance[1])
    return min(times, default=float("inf"))


def is_visible(place: Place, eyes: Place) -> bool:
    """Return whether the robot may look at a position."""
    return _distance(place, eyes) >= MIN_DISTANCE and abs(azimuth(place, eyes)) <= MAX_AZIMUTH


def is_near(place: Place, eyes: Place) -> bool:
    """Return whether the robot attends to a person at a position."""
    return is_visible(place, eyes) and _distance(place, eyes) <= MAX_DISTANCE


def azimuth(place: Place, eyes: Place) -> float:
    """Return the horizontal direction of a position [deg].

    Positive to the left.
    """
    return degrees(atan2(place[1] - eyes[1], place[0] - eyes[0]))


def direction_change(one: Place, other: Place, eyes: Place) -> float:
    """Return the larger difference of azimuth or elevation of two positions [deg]."""
    sides = abs((azimuth(one, eyes) - azimuth(other, eyes) + 180.0) % 360.0 - 180.0)
    return max(sides, abs(_elevation(one, eyes) - _elevation(other, eyes)))


def _follow(person: TrackedPerson, report: Person, time: float, eyes: Place) -> TrackedPerson:
    """Move a person towards a reported position.

    A sudden jump must persist for `JUMP_DELAY`.
    """
    jump = person.jump
    if direction_change(report.place, person.place, eyes) > JUMP_ANGLE:
        if jump is None or direction_change(report.place, jump[0], eyes) > JUMP_ANGLE:
            jump = (report.place, time)
        if time - jump[1] < JUMP_DELAY:
            return replace(person, seen=time, looks=report.looks, jump=jump)
        return replace(person, place=report.place, seen=time, looks=report.looks, jump=None)
    weight = 1.0 - exp(-max(0.0, time - person.seen) / SMOOTHING_TIME)
    x, y, z = (a + weight * (b - a) for a, b in zip(person.place, report.place, strict=True))
    return replace(person, place=(x, y, z), seen=time, looks=report.looks, jump=None)


def _score(person: TrackedPerson, roles: Roles, eyes: Place) -> float:
    """Return the score with which a person attracts attention."""
    names = (person.key, person.id)
    proximity = PROXIMITY_SCORE * (1.0 - _distance(person.place, eyes) / MAX_DISTANCE)
    return (
        SPEAKER_SCORE * (roles.speaker in names)
        + ADDRESSEE_SCORE * (roles.addressee in names)
        + LOOK_SCORE * person.looks
        + proximity
    )


def _new_key(id: str, people: Company) -> str:
    """Return an unused key for a new person, if possible the id."""
    keys = {person.key for person in people.tracked}
    names = (id, *(f"{id}-{number}" for number in range(2, len(keys) + 3)))
    return next(name for name in names if name not in keys)


def _distance(place: Place, eyes: Place) -> float:
    return dist(place, eyes)


def _elevation(place: Place, eyes: Place) -> float:
    return degrees(atan2(place[2] - eyes[2], hypot(place[0] - eyes[0], place[1] - eyes[1])))
