import subprocess
import sys

import pytest

from kinesic.bench.plan.hostile import HOSTILE_DOCUMENTS, measure_hostile_plan
from kinesic.bml.block import BmlError
from kinesic.motion import key_times
from kinesic.motion.key_time_tuning import SEARCH_TUNING
from kinesic.planning import clashes
from kinesic.planning import plan as plan_module
from kinesic.session.plan import plan

REFUSED_NAMES = ("huge_numbers", "repetition", "nested")
QUICK_NAMES = ("ring_of_ends", "unreachable_times", "attribute_2_mb", *REFUSED_NAMES)


@pytest.fixture(scope="module")
def lexemes(known):
    return [form.id for form in known.lexicon.forms]


@pytest.mark.parametrize("name", QUICK_NAMES)
def test_hostile_document_is_planned_or_refused_with_a_location(name, known, lexemes):
    text = HOSTILE_DOCUMENTS[name](lexemes)
    if name in REFUSED_NAMES:
        with pytest.raises(BmlError, match=r"^<text>:1:"):
            plan(text, known)
    else:
        assert plan(text, known).timeline.block.id == "crowd"


@pytest.mark.soak
def test_fifty_overlapping_gestures_stay_within_the_planning_budgets(known, lexemes, monkeypatch):
    pieces, rounds = [], []
    measure, solve = key_times.measure_time_deficit, plan_module.solve_postures

    def count(segment, limits, **options):
        pieces.append(segment.grid.pieces)
        return measure(segment, limits, **options)

    monkeypatch.setattr(key_times, "measure_time_deficit", count)
    monkeypatch.setattr(plan_module, "solve_postures", lambda *given: rounds.append(1) or solve(*given))
    planned = plan(HOSTILE_DOCUMENTS["pile_50"](lexemes), known)
    kinds = [outcome.kind for outcome in planned.keyframes.outcomes.values()]
    assert 5 < len(kinds) - kinds.count("dropped") < len(kinds)
    assert sum(pieces) < plan_module.WORK_BUDGET + clashes.SEARCH_BUDGET + SEARCH_TUNING.max_evaluations
    assert len(rounds) < 30


@pytest.mark.soak
def test_planning_process_reports_cpu_time_memory_and_refusal():
    cost = measure_hostile_plan("repetition")
    assert cost.ending.startswith("refused: <text>:1:")
    assert cost.cpu >= 0.0
    assert cost.memory > 10.0


@pytest.mark.soak
def test_measured_peak_memory_includes_freed_memory():
    code = "from kinesic.bench.plan.plan_process import peak_memory as p; print(p(), bool(bytearray(3 * 10**8)), p())"
    before, _, after = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=True, text=True
    ).stdout.split()
    assert float(after) > float(before) + 250.0
