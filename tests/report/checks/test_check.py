"""Status of a checked value: pass, warn, poor or fail."""

import re
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import CHECK_LIMITS, SEVERITY_RANKS, Check, format_time, grade
from kinesic.report.checks.content import content_checks
from kinesic.report.checks.servos import draw_load, loads, power_checks
from kinesic.report.checks.twin import measure_tracking, stroke_errors

REFERENCE_PAGE = Path(__file__).parents[3] / "docs" / "reference" / "report.md"
CHECK_ROW = re.compile(r"^\| (`\w+\.\w+`(?:, `\w+\.\w+`)*) \| .+ \| (.+) \|$", re.MULTILINE)
POOR_BOUNDS = re.compile(r"poor (?:above|below) ([\d.]+(?:, [\d.]+)*(?: and [\d.]+)?)( ms)?")


@dataclass(frozen=True)
class DocumentedLimit:
    """Limit of one check as documented in docs/reference/report.md."""

    is_fatal: bool
    at_least: bool
    poor: float | None


def documented_limits() -> dict[str, DocumentedLimit]:
    """Read the limits of all checks from the reference page of reports."""
    limits: dict[str, DocumentedLimit] = {}
    for names, text in CHECK_ROW.findall(REFERENCE_PAGE.read_text(encoding="utf-8")):
        checks, match = re.findall(r"\w+\.\w+", names), POOR_BOUNDS.search(text)
        bounds = [] if match is None else [float(bound) for bound in re.findall(r"[\d.]+", match[1])]
        scale = 0.001 if match is not None and match[2] else 1.0
        for k, check in enumerate(checks):
            poor = scale * bounds[min(k, len(bounds) - 1)] if bounds else None
            limits[check] = DocumentedLimit(text.startswith("fails"), "below" in text, poor)
    return limits


DOCUMENTED_LIMITS = documented_limits()
POOR_LIMITS = {name: limit.poor for name, limit in DOCUMENTED_LIMITS.items() if limit.poor is not None}
FATAL_CHECKS = {name for name, limit in DOCUMENTED_LIMITS.items() if limit.is_fatal}
MINIMUM_CHECKS = {name for name, limit in DOCUMENTED_LIMITS.items() if limit.at_least}


def test_reference_page_of_reports_documents_the_limit_of_each_check():
    assert sorted(DOCUMENTED_LIMITS) == sorted(CHECK_LIMITS), (
        "edit CHECK_LIMITS in kinesic/report/checks/check.py or the table of checks in docs/reference/report.md"
    )
    for name, limit in CHECK_LIMITS.items():
        documented = DocumentedLimit(limit.beyond == "fail", limit.at_least, limit.poor)
        assert DOCUMENTED_LIMITS[name] == documented, f"{name}: docs/reference/report.md and CHECK_LIMITS differ"


def test_error_for_a_check_without_a_limit_names_the_file_to_edit():
    with pytest.raises(LookupError, match=r"servo\.unknown: add it to CHECK_LIMITS in kinesic/report/checks/check\.py"):
        Check.of("servo.unknown", 1.0, 2.0)


@pytest.mark.parametrize("name", DOCUMENTED_LIMITS)
def test_check_passes_at_its_limit_and_warns_or_fails_beyond_it(name: str):
    worse = -1.0 if name in MINIMUM_CHECKS else 1.0
    bound = POOR_LIMITS.get(name, 0.0)
    limit = 0.5 if name == "limits.holding" else bound - 0.1 * worse  # well inside of what is poor
    assert Check.of(name, limit, limit).status == "pass"
    assert Check.of(name, limit + 0.01 * worse, limit).status == ("fail" if name in FATAL_CHECKS else "warn")
    assert Check.of(name, limit + 0.01 * worse, limit, slack=0.02).status == "pass"
    assert Check.of(name, nan, limit).status == (
        "fail" if name in FATAL_CHECKS else "poor" if name in POOR_LIMITS else "warn"
    )


@pytest.mark.parametrize(("name", "bound"), POOR_LIMITS.items())
def test_check_beyond_its_poor_threshold_gets_the_status_poor(name: str, bound: float):
    worse = -1.0 if name in MINIMUM_CHECKS else 1.0
    limit = bound - 0.1 * worse
    assert Check.of(name, bound, limit).status == "warn"
    result = Check.of(name, bound + 0.001 * worse, limit, "somewhere")
    assert (result.status, result.limit, result.at_least) == ("poor", bound, name in MINIMUM_CHECKS)
    assert (result.value, result.unit, result.where) == (bound + 0.001 * worse, CHECK_LIMITS[name].unit, "somewhere")


def test_holding_torque_above_80_percent_of_stall_torque_fails():
    assert Check.of("limits.holding", 0.8, 0.5).status == "warn"
    result = Check.of("limits.holding", 0.81, 0.5, "l_elbow")
    assert (result.status, result.limit, result.where) == ("fail", 0.8, "l_elbow")


def test_grade_of_a_performance_follows_its_most_severe_check_status():
    def graded(*names: str) -> str:
        return grade(Check("x", name, 0.0, 0.0, "m") for name in names)

    assert (graded(), graded("pass", "warn")) == ("ok", "ok")
    assert graded("warn", "poor", "pass") == "poor"
    assert graded("poor", "fail", "pass") == "fail"
    assert (
        list(SEVERITY_RANKS)
        == sorted(SEVERITY_RANKS, key=lambda each: SEVERITY_RANKS[each])
        == ["fail", "poor", "warn", "pass"]
    )


def test_no_two_check_statuses_have_the_same_severity():
    assert list(SEVERITY_RANKS.values()) == [0, 1, 2, 3]


def test_times_in_checks_are_formatted_with_two_decimals_and_without_negative_zero():
    assert [format_time(time) for time in (1.234, -0.001, 12.0)] == ["at 1.23 s", "at 0.00 s", "at 12.00 s"]


def test_check_of_performed_fraction_names_dropped_behaviours(calm: DryRun, hurried: DryRun):
    whole, part = (content_checks(item)[0] for item in (calm, hurried))
    assert (whole.name, whole.value, whole.status, whole.where) == ("meaning.performed", 1.0, "pass", "")
    assert (part.value, part.status) == (0.75, "poor")
    assert part.where.startswith("dropped: xyzzy")


def test_tracking_metrics_summarise_stroke_times_clearance_and_tracking_errors(hurried: DryRun):
    tracking = measure_tracking(hurried)
    errors = [abs(error) for error, _ in stroke_errors(hurried) if error is not None]
    assert errors
    assert tracking.strokes == len(stroke_errors(hurried))
    assert tracking.strokes_lost == tracking.strokes - len(errors)
    assert tracking.stroke_median_s == pytest.approx(np.median(errors))
    assert tracking.stroke_p95_s == pytest.approx(np.percentile(errors, 95))
    assert tracking.min_distance_m == hurried.measured.clearance.distances.min()
    assert (tracking.rmse_deg, tracking.p95_deg, tracking.max_deg) == (
        hurried.tracking.rmse,
        hurried.tracking.p95,
        hurried.tracking.max,
    )


def test_planned_duty_is_the_maximum_per_joint(hurried: DryRun):
    names = hurried.plan.setup.robot.skeleton.names
    largest = np.abs(hurried.reference.duties).max(axis=0)
    assert {load.hinge: load.planned for load in loads(hurried)} == pytest.approx(
        dict(zip(names, largest.tolist(), strict=True))
    )


def test_current_draw_is_compared_with_the_current_limit_of_the_supply(hurried: DryRun):
    supply, power = hurried.plan.setup.robot.supply, hurried.measured.power
    load = draw_load(hurried)
    assert load.allowed == supply.amps
    assert load.peak_at == hurried.measured.times[power.peak.argmax()]
    assert load.mean == pytest.approx(power.mean.mean())
    checks = {check.name: check for check in power_checks(hurried)}
    assert checks["power.peak"].value == power.peak.max()
    assert checks["power.mean"].value == pytest.approx(power.mean.mean())
    assert checks["power.peak"].limit == checks["power.mean"].limit == supply.amps
    assert checks["power.peak"].where == format_time(load.peak_at)
    if power.warming:
        assert checks["power.warming"].value == load.warming == max(rise.max() for rise in power.warming.values())
        assert checks["power.warming"].where.startswith(f"{load.warmest} at ")


def test_shortening_of_stroke_paths_is_compared_with_5_percent(calm: DryRun):
    path = {check.name: check for check in content_checks(calm)}["amplitude.path"]
    assert (path.limit, path.unit, path.value, path.where) == (0.05, "ratio", 0.0, "")


@pytest.mark.parametrize(
    ("unit", "lost", "seen"), [("m", 0.021, True), ("m", 0.019, False), ("deg", 3.1, True), ("deg", 2.9, False)]
)
def test_only_visible_shortening_of_a_stroke_path_counts(calm: DryRun, unit: str, lost: float, seen: bool):
    loss = SimpleNamespace(asked=10.0 * lost, planned=9.0 * lost, fraction=0.1, part="r_hand", unit=unit)
    change = SimpleNamespace(behaviour="offering", losses=(loss,))
    performance = replace(calm, reference=replace(calm.reference))
    performance.reference.__dict__["changes"] = (change,)
    path = {check.name: check for check in content_checks(performance)}["amplitude.path"]
    assert path.value == (0.1 if seen else 0.0)
    assert path.where == ("r_hand in offer (offering), smaller for lack of time" if seen else "")
