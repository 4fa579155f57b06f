from kinesic.body.arrays import sealed
from kinesic.body.dynamics import Clearance


def test_the_worst_is_the_closest_approach():
    clearance = Clearance(sealed([0.05, -0.01, 0.02]), [("a", "b"), ("a", "c"), ("b", "c")])
    assert clearance.pairs[clearance.worst] == ("a", "c")
