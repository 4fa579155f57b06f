from kinesic.motion.budget import UNLIMITED_BUDGET, Budget


def test_work_budget_is_spent_once_the_work_exceeds_the_budget():
    budget = Budget(10)
    budget.spend(10)
    assert not budget.spent
    budget.spend(1)
    assert budget.spent


def test_unlimited_work_budget_is_not_spent_by_a_trillion_units():
    UNLIMITED_BUDGET.spend(1e12)
    assert not UNLIMITED_BUDGET.spent


def test_work_budget_reports_remaining_work_and_overdraft():
    budget = Budget(10)
    budget.spend(4)
    assert (budget.left, budget.overdraft) == (6, 0)
    budget.spend(31)
    assert (budget.left, budget.overdraft) == (0, 2.5)
