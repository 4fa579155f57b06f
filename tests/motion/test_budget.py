from kinesic.motion.budget import ENDLESS, Budget


def test_a_budget_is_spent_when_more_is_done_than_it_has():
    budget = Budget(10)
    budget.spend(10)
    assert not budget.spent
    budget.spend(1)
    assert budget.spent


def test_what_is_bounded_by_itself_spends_no_budget():
    ENDLESS.spend(1e12)
    assert not ENDLESS.spent


def test_a_budget_reports_what_is_left_and_how_far_it_is_exceeded():
    budget = Budget(10)
    budget.spend(4)
    assert (budget.left, budget.overdraft) == (6, 0)
    budget.spend(31)
    assert (budget.left, budget.overdraft) == (0, 2.5)
