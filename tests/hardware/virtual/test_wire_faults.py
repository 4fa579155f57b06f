import pytest

from kinesic.hardware.virtual.faults import FaultPlan, Kind, PlannedFault
from kinesic.hardware.virtual.protocol import Sent
from kinesic.hardware.virtual.wire_faults import WireFaults

DATA = bytes(range(20))


def struck(kind: Kind, *, seed: int = 1, **changes: object) -> list[bytes]:
    weather = WireFaults(FaultPlan((PlannedFault(kind, **changes),), seed))
    return [heard.data for heard in weather.replies([Sent(1, DATA)], 0.0)]


def test_each_fault_does_what_its_name_says():
    for seed in range(20):
        corrupt, drop, cut, noise = (struck(kind, seed=seed)[0] for kind in ("corrupt", "drop", "truncate", "noise"))
        assert sum(a != b for a, b in zip(corrupt, DATA, strict=True)) == 1
        assert len(drop) == len(DATA) - 1
        assert any(drop == DATA[:k] + DATA[k + 1 :] for k in range(len(DATA)))
        assert DATA.startswith(cut)
        assert noise.endswith(DATA)
        assert 1 <= len(noise) - len(DATA) <= 8
    assert struck("duplicate")[0] == DATA + DATA
    assert struck("lost") == []


def test_only_the_servos_named_are_struck_and_only_in_time():
    assert struck("lost", servos=(2,)) == [DATA]
    assert struck("lost", start=1.0) == [DATA]


def test_an_answer_of_several_servos_is_struck_at_one_place():
    weather = WireFaults(FaultPlan((PlannedFault("corrupt", servos=(2, 3)),), 3))
    places = set()
    for _ in range(40):
        answer = weather.replies([Sent(servo, DATA) for servo in (1, 2, 3, 4)], 0.0)
        (place,) = [k for k, heard in enumerate(answer) if heard.data != DATA]
        places.add(place)
    assert places == {1, 2}


def test_a_lost_block_ends_a_chain():
    weather = WireFaults(FaultPlan((PlannedFault("lost", servos=(2,)),)))
    chain = [Sent(servo, DATA, chained=True) for servo in (1, 2, 3)]
    assert len(weather.replies(chain, 0.0)) == 1
    assert len(weather.replies([Sent(servo, DATA) for servo in (1, 2, 3)], 0.0)) == 2


def test_rates_are_rates_and_seeds_are_seeds():
    def lost(seed: int) -> list[int]:
        weather = WireFaults(FaultPlan((PlannedFault("lost", rate=0.05),), seed))
        return [len(weather.replies([Sent(1, DATA)], 0.0)) for _ in range(4000)]

    assert sum(lost(1)) / 4000 == pytest.approx(0.95, abs=0.01)
    assert lost(1) == lost(1)
    assert lost(1) != lost(2)


def test_late_is_a_time_and_requests_have_faults_of_their_own():
    weather = WireFaults(FaultPlan((PlannedFault("late", value=0.02), PlannedFault("lost", way="request"))))
    (heard,) = weather.replies([Sent(1, DATA)], 0.0)
    assert (heard.data, heard.late) == (DATA, 0.02)
    assert weather.request(DATA, 0.0) == b""
