import subprocess
import sys

import pytest

from kinesic.bench.plan.hostile import DOCUMENTS, measure_plan
from kinesic.bml.block import BmlError
from kinesic.controller.perform import plan
from kinesic.motion import key_times
from kinesic.motion.key_times import LOOKS
from kinesic.planning import clashes
from kinesic.planning import plan as plan_module

REFUSED = ("huge_numbers", "repetition", "nested")
SWIFT = ("ring_of_ends", "unreachable_times", "attribute_2_mb", *REFUSED)


@pytest.fixture(scope="module")
def lexemes(known):
    return [form.id for form in known.lexicon.forms]


@pytest.mark.parametrize("name", SWIFT)
def test_hostile_documents_are_planned_or_refused_with_a_place(name, known, lexemes):
    text = DOCUMENTS[name](lexemes)
    if name in REFUSED:
        with pytest.raises(BmlError, match=r"^<text>:1:"):
            plan(text, known)
    else:
        assert plan(text, known).timeline.block.id == "crowd"


def test_a_pile_takes_no_more_than_its_budgets(known, lexemes, monkeypatch):
    pieces, rounds = [], []
    measure, solve = key_times.measure_shortage, plan_module.postures

    def count(segment, limits, **options):
        pieces.append(segment.grid.pieces)
        return measure(segment, limits, **options)

    monkeypatch.setattr(key_times, "measure_shortage", count)
    monkeypatch.setattr(plan_module, "postures", lambda *given: rounds.append(1) or solve(*given))
    found = plan(DOCUMENTS["pile_50"](lexemes), known)
    kinds = [outcome.kind for outcome in found.keyframes.outcomes.values()]
    assert 5 < len(kinds) - kinds.count("dropped") < len(kinds)
    assert sum(pieces) < plan_module.WORK + clashes.WORK + LOOKS
    assert len(rounds) < 30


def test_a_process_says_what_a_plan_took():
    cost = measure_plan("repetition")
    assert cost.ending.startswith("refused: <text>:1:")
    assert cost.cpu >= 0.0
    assert cost.memory > 10.0


def test_memory_that_was_had_once_counts():
    code = "from kinesic.bench.plan.plan_process import peak_memory as p; print(p(), bool(bytearray(3 * 10**8)), p())"
    before, _, after = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=True, text=True
    ).stdout.split()
    assert float(after) > float(before) + 250.0
