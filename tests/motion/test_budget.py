from math import inf

from kinesic.motion.budget import UNLIMITED_BUDGET, Budget


def test_work_budget_is_spent_once_the_work_exceeds_the_budget():
    budget = Budget(10)
    budget.spend(10)
    assert not budget.spent
    budget.spend(1)
    assert budget.spent


def test_unlimited_work_budget_remains_after_a_trillion_units_of_work():
    UNLIMITED_BUDGET.spend(1e12)
    assert not UNLIMITED_BUDGET.spent


def test_work_budget_reports_remaining_work_and_overdraft():
    budget = Budget(10)
    budget.spend(4)
    assert (budget.left, budget.overdraft) == (6, 0)
    budget.spend(31)
    assert (budget.left, budget.overdraft) == (0, 2.5)


def test_new_work_budget_has_all_of_its_work_left():
    assert (Budget(7).left, Budget(7).overdraft, Budget(7).spent) == (7, 0, False)
    assert (Budget().left, UNLIMITED_BUDGET.left) == (inf, inf)


def test_overdraft_of_a_budget_below_one_unit_is_measured_in_units():
    for work in (0.0, 0.5, 1.0):
        budget = Budget(work)
        assert not budget.spent
        budget.spend(work + 3.0)
        assert (budget.spent, budget.left, budget.overdraft) == (True, 0.0, 3.0)
    larger = Budget(2.0)
    larger.spend(5.0)
    assert larger.overdraft == 1.5
