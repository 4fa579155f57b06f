"""One-line verdict of a report: failed checks and dropped behaviours."""

import re

import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.report.report import Json, report
from kinesic.report.verdict import verdict
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors


@pytest.fixture(scope="module")
def data(hurried: DryRun) -> dict[str, Json]:
    return report(hurried, source="hurried.bml")


def test_verdict_names_failed_checks(data: dict[str, Json]) -> None:
    line = verdict(data)
    assert re.match(r"poor: hurried\.bml on upper22, [\d.]+ s, 1 of 4 dropped: xyzzy; .*\d+ warnings$", line)
    whole = data | {"checks": [], "behaviours": [], "warnings": []}
    assert re.match(r"ok: hurried\.bml on upper22, [\d.]+ s, nothing fails$", verdict(whole))
    wrong: dict[str, Json] = {"name": "collision.twin", "status": "fail", "value": 0.004, "limit": 0.01}
    data = whole
    assert re.match(r"fail: .*, collision\.twin 0\.004 \(limit 0\.01\)", verdict(data | {"checks": [wrong]}))
    late: dict[str, Json] = {"name": "timing.shift", "status": "poor", "value": 6.0, "limit": 0.5, "at_least": False}
    assert re.match(r"poor: .* s, timing\.shift 6 \(poor above 0\.5\)", verdict(data | {"checks": [late]}))
    both = verdict(data | {"checks": [late, wrong]})
    assert re.match(r"fail: .*, collision\.twin 0\.004 \(limit 0\.01\), timing\.shift 6 \(poor above 0\.5\)", both)


def test_verdict_names_three_of_many_dropped_behaviours(data: dict[str, Json]) -> None:
    rows: list[Json] = [{"id": f"g{k}", "name": f"x{k}", "outcome": "dropped"} for k in range(5)]
    few: list[Json] = [*rows[:1], *({"id": f"h{k}", "name": "beat", "outcome": "realised"} for k in range(9))]
    assert "5 of 5 dropped: x0, x1, x2 and 2 more" in verdict(data | {"checks": [], "behaviours": rows})
    assert verdict(data | {"checks": [], "behaviours": few}).startswith("ok: ")
    assert "1 of 10 dropped: x0" in verdict(data | {"checks": [], "behaviours": few})


def test_verdict_names_the_style_unless_it_is_neutral(data: dict[str, Json]) -> None:
    assert re.search(r"on upper22, [\d.]+ s", verdict(data | {"style": {"name": "neutral"}}))
    assert re.search(r"on upper22, joyful, [\d.]+ s", verdict(data | {"style": {"name": "joyful"}}))


OFFER = '<gesture id="g" lexeme="offer" mode="BOTH_HANDS" stroke="1.0" end="2"/>'
NODS = '<head id="h" lexeme="NOD" amount="1" repetition="6" start="0.5" end="1.2"/>'
UNKNOWN_GESTURE = '<gesture id="x" lexeme="xyzzy" stroke="1"/>'


@pytest.mark.parametrize(
    ("document", "servos", "correction", "named"),
    [
        (NODS, NOMINAL_FACTORS, True, "timing.shift"),
        (OFFER + UNKNOWN_GESTURE, NOMINAL_FACTORS, True, "1 of 2 dropped: xyzzy"),
        (OFFER, Factors(latency=0.2), False, "tracking.lateness"),
        (OFFER, Factors(gain=3.0, latency=0.03), True, "smoothness.hands"),
    ],
    ids=["shifted", "dropped", "late", "trembling"],
)
def test_verdict_of_a_poor_document_names_the_check(known, document, servos, correction, named):
    planned = plan(f'<bml id="b">{document}</bml>', known)
    line = verdict(report(dry_run(planned, twin=servos, correction=correction), source="b.bml"))
    assert line.startswith("poor: ")
    assert named in line


def test_verdict_counts_missed_goals_and_warnings(data: dict[str, Json]) -> None:
    def said(*statuses: str, warnings: int = 0) -> str:
        checks: list[Json] = [
            {"name": "timing.shift", "status": status, "value": 1.0, "limit": 2.0} for status in statuses
        ]
        return verdict(data | {"checks": checks, "behaviours": [], "warnings": [{"text": "x"}] * warnings})

    assert said("pass", "pass").endswith("nothing fails")
    assert said("warn", "pass", "pass").endswith("nothing fails; 1 missed goal")
    assert said("warn", "warn", "pass", warnings=1).endswith("; 2 missed goals, 1 warning")
