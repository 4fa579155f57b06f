from kinesic.body.arrays import sealed
from kinesic.body.dynamics import Clearance


def test_worst_posture_of_a_clearance_result_has_the_smallest_segment_distance():
    clearance = Clearance(sealed([0.05, -0.01, 0.02]), [("a", "b"), ("a", "c"), ("b", "c")])
    assert clearance.pairs[clearance.worst] == ("a", "c")
