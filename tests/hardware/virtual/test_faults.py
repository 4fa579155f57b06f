from math import inf
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.hardware.virtual.faults import DEFAULT_VALUES, FAULT_KINDS, FaultKind, FaultPlan, PlannedFault, WireFaults
from kinesic.hardware.virtual.protocol import Sent

DATA = bytes(range(20))


def test_fault_plan_is_read_from_file(tmp_path: Path):
    path = tmp_path / "faults.toml"
    path.write_text(
        'seed = 7\n[[fault]]\nkind = "corrupt"\nrate = 0.01\n'
        '[[fault]]\nkind = "reboot"\nservos = [3]\nstart = 2.0\nvalue = 0.4\n'
        '[[fault]]\nkind = "unplug"\nstart = 1.0\nseconds = 0.2\n',
        encoding="utf-8",
    )
    plan = FaultPlan.read(path)
    assert plan.seed == 7
    assert plan.faults == (
        PlannedFault("corrupt", rate=0.01),
        PlannedFault("reboot", servos=(3,), start=2.0, value=0.4),
        PlannedFault("unplug", start=1.0, seconds=0.2),
    )
    assert plan.of(frozenset({"unplug"})) == plan.faults[2:]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[fault]]\nkind = "gremlin"', r"Invalid enum value 'gremlin'"),
        ('[[fault]]\nkind = "corrupt"\nrate = 1.5', r"corrupt: rate is 1.5, must be within 0\.\.1"),
        ('[[fault]]\nkind = "reboot"\nrate = 0.5', "reboot has no rate; give it a start"),
        ('[[fault]]\nkind = "corrupt"\nvalue = 5', "corrupt has no value; those with one are late, noise"),
        ('[[fault]]\nkind = "silent"\nstart = -1.0', "start is -1.0 s"),
        ('[[fault]]\nkind = "silent"\nsecond = 1.0', "unknown field `second`.*did you mean seconds"),
    ],
)
def test_error_for_an_invalid_fault_plan_names_the_wrong_entry(tmp_path: Path, text: str, message: str):
    path = tmp_path / "faults.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        FaultPlan.read(path)


def test_planned_fault_without_a_value_uses_the_default_of_its_kind():
    assert PlannedFault("late").effective_value == DEFAULT_VALUES["late"]
    assert PlannedFault("late", value=0.1).effective_value == 0.1
    assert set(DEFAULT_VALUES) < set(FAULT_KINDS)


def test_planned_fault_lasts_for_its_duration_from_its_start_time():
    fault = PlannedFault("silent", servos=(2,), start=1.0, seconds=0.5)
    assert [fault.affects(2, time) for time in (0.9, 1.0, 1.4, 1.5)] == [False, True, True, False]
    assert not fault.affects(3, 1.2)
    assert PlannedFault("silent").end == inf


def struck(kind: FaultKind, *, seed: int = 1, **changes: object) -> list[bytes]:
    weather = WireFaults(FaultPlan((PlannedFault(kind, **changes),), seed))
    return [heard.data for heard in weather.replies([Sent(1, DATA)], 0.0)]


def test_wire_faults_change_drop_truncate_prepend_or_duplicate_bytes_of_a_reply():
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


def test_planned_faults_affect_only_named_servos_during_their_time():
    assert struck("lost", servos=(2,)) == [DATA]
    assert struck("lost", start=1.0) == [DATA]


def test_fault_of_several_servos_damages_the_reply_of_one_of_them_at_a_time():
    weather = WireFaults(FaultPlan((PlannedFault("corrupt", servos=(2, 3)),), 3))
    places = set()
    for _ in range(40):
        answer = weather.replies([Sent(servo, DATA) for servo in (1, 2, 3, 4)], 0.0)
        (place,) = [k for k, heard in enumerate(answer) if heard.data != DATA]
        places.add(place)
    assert places == {1, 2}


def test_fast_reply_ends_where_the_block_of_a_servo_is_lost():
    weather = WireFaults(FaultPlan((PlannedFault("lost", servos=(2,)),)))
    chain = [Sent(servo, DATA, chained=True) for servo in (1, 2, 3)]
    assert len(weather.replies(chain, 0.0)) == 1
    assert len(weather.replies([Sent(servo, DATA) for servo in (1, 2, 3)], 0.0)) == 2


def test_random_faults_have_their_rate_and_depend_only_on_the_seed():
    def lost(seed: int) -> list[int]:
        weather = WireFaults(FaultPlan((PlannedFault("lost", rate=0.05),), seed))
        return [len(weather.replies([Sent(1, DATA)], 0.0)) for _ in range(4000)]

    assert sum(lost(1)) / 4000 == pytest.approx(0.95, abs=0.01)
    assert lost(1) == lost(1)
    assert lost(1) != lost(2)


def test_late_fault_delays_replies_and_request_fault_drops_requests():
    weather = WireFaults(FaultPlan((PlannedFault("late", value=0.02), PlannedFault("lost", way="request"))))
    (heard,) = weather.replies([Sent(1, DATA)], 0.0)
    assert (heard.data, heard.late) == (DATA, 0.02)
    assert weather.request(DATA, 0.0) == b""
