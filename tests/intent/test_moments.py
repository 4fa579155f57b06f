"""Tests of BML references as times of intents."""

import pytest

from kinesic.intent.intents import Moment, shift_reference, split_reference


@pytest.mark.parametrize(
    ("reference", "parts"),
    [
        ("s:w3", ("s:w3", None)),
        ("s:w3+0.12", ("s:w3", 0.12)),
        ("s:w3 - 1.5", ("s:w3", -1.5)),
        ("g-1:end", ("g-1:end", None)),
        ("g-1:end+.5", ("g-1:end", 0.5)),
        ("s:w3+1.2.3", ("s:w3+1.2.3", None)),
        ("1.5", ("", 1.5)),
        ("2", ("", 2.0)),
        ("-2", ("", -2.0)),
        ("s:w3+\u00b2", ("s:w3+\u00b2", None)),
    ],
)
def test_time_reference_is_split_into_point_and_offset(reference: str, parts: tuple[str, float | None]) -> None:
    assert split_reference(reference) == parts


@pytest.mark.parametrize(
    ("reference", "seconds", "shifted"),
    [
        ("s:w3", 0.5, "s:w3+0.50"),
        ("s:w3", -0.5, "s:w3-0.50"),
        ("s:w3+0.12", 0.08, "s:w3+0.20"),
        ("s:w3+0.12", -0.12, "s:w3"),
        ("s:w3", 0.004, "s:w3"),
        ("s:w3", -0.006, "s:w3-0.01"),
        ("1.5", 0.25, "1.75"),
        ("1.5", -2.0, "0.00"),
    ],
)
def test_shifted_time_reference_has_the_added_offset_but_is_not_negative(
    reference: str, seconds: float, shifted: str
) -> None:
    assert shift_reference(Moment(reference, 0.0), seconds) == shifted
    moment = Moment(reference, 3.0).later(seconds)
    assert moment.reference == shifted
    assert moment.seconds == pytest.approx(3.0 + seconds)
