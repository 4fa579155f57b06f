"""Registers of the servo models, compared with the independent table in `tests/manual_servo`."""

import pytest

from kinesic.hardware.protocol.models import SERVO_MODELS, Model
from kinesic.hardware.protocol.registers import Register

from ...manual_servo.table import MODELS, items
from ...naming import about

BY_ADDRESS = {register.field.address: register for register in Register}
UNSPECIFIED_INITIALS = {
    "firmware",
    "volts",
    "celsius",
    "shutdown",
}  # measured values; shutdown is 53 or 52, by edition of the manual
UNSPECIFIED_RANGES = {"drive_mode", "secondary_id"}  # the editions of the manual differ
MODEL_INITIALS = {  # factory values of the velocity controller that the independent table leaves out
    ("xl430_w250", "velocity_i"): 1000,
    ("xl330_m288", "velocity_i"): 1600,
    ("xl330_m288", "velocity_p"): 180,
}
MODEL_RANGES = dict.fromkeys((("xl330_m288", "max_voltage"), ("xl330_m288", "min_voltage")), (31, 70))  # [0.1 V]
SERIES_TEMPERATURES = {"xl330": 70, "xc330": 70, "xl430": 72, "xc430": 80, "xm430": 80, "xh430": 80}  # [C] limits
SERIES_TEMPERATURES |= {"xm540": 80, "xh540": 80, "xw540": 80}  # [C]
SERIES_VOLTAGES = {"xl330": (35, 70), "xl430": (60, 140), "xc430": (60, 160), "xm430": (95, 160)}  # [0.1 V]
SERIES_VOLTAGES |= dict.fromkeys(("xh430", "xm540", "xh540", "xw540"), (95, 160))  # [0.1 V]
X_SERIES = {name: model for name, model in SERVO_MODELS.items() if model.table is None}
EVERY_MODEL = pytest.mark.parametrize("model", X_SERIES.values(), ids=list(X_SERIES))


@pytest.mark.parametrize("name", MODELS)
def test_register_sizes_and_values_of_a_servo_model_agree_with_an_independently_written_table(name: str):
    model = SERVO_MODELS[name]
    for label, item in items(MODELS[name], 1, 52).items():
        register = BY_ADDRESS[item.address]
        with about(label):
            assert model.has(register)
            assert (register.field.size, register.field.signed) == (item.size, item.signed)
            assert register.field.writable == item.writable
            assert register.field.eeprom == item.lasting
            if label not in UNSPECIFIED_INITIALS:
                assert model.factory_value(register) == MODEL_INITIALS.get((name, label), item.initial)
            if item.bounds is not None and item.writable and label not in UNSPECIFIED_RANGES:
                assert model.allowed_range(register) == MODEL_RANGES.get((name, label), item.bounds)


@pytest.mark.parametrize("name", MODELS)
def test_servo_model_has_exactly_the_registers_of_an_independently_written_table(name: str):
    addresses = {item.address for item in items(MODELS[name], 1, 52).values()}
    assert {register.field.address for register in SERVO_MODELS[name].registers} == addresses


@pytest.mark.parametrize("name", MODELS)
def test_operating_modes_indirect_cells_and_current_unit_agree_with_the_independent_table(name: str):
    model, expected = SERVO_MODELS[name], MODELS[name]
    assert {mode.value for mode in model.modes} == set(expected.modes)
    assert model.amperes == (None if expected.amperes is None else pytest.approx(expected.amperes))
    assert {(cells.addresses, cells.data, cells.count) for cells in model.cells} == {
        (*window, expected.cells) for window in expected.windows
    }
    assert model.fast_firmware == expected.fast


@EVERY_MODEL
def test_factory_temperature_limit_is_that_of_the_servo_series(model: Model):
    series = model.name.removeprefix("2")[:5]
    assert series in SERIES_TEMPERATURES, f"add {series} to SERIES_TEMPERATURES and SERIES_VOLTAGES above"
    assert model.factory_value(Register.TEMPERATURE_LIMIT) == SERIES_TEMPERATURES[series]


@EVERY_MODEL
def test_factory_voltage_limits_are_those_of_the_servo_series(model: Model):
    limits = tuple(
        model.factory_value(register) for register in (Register.MIN_VOLTAGE_LIMIT, Register.MAX_VOLTAGE_LIMIT)
    )
    expected = SERIES_VOLTAGES.get(model.name.removeprefix("2")[:5])
    assert limits == (expected or ((35, 70) if "_m" in model.name else (55, 140)))


@EVERY_MODEL
def test_factory_position_gains_have_no_i_or_d_term_except_on_listed_models(model: Model):
    registers = (Register.POSITION_P_GAIN, Register.POSITION_I_GAIN, Register.POSITION_D_GAIN)
    proportional, integral, derivative = (model.factory_value(register) for register in registers)
    assert 400 <= proportional <= 1200
    assert integral == (400 if model.name == "xl330_m077" else 0)
    derivatives = {"xl430_w250": 4000, "2xl430_w250": 2000, "xc330_m181": 500, "xc330_m288": 500}
    assert derivative == derivatives.get(model.name, 0)


@EVERY_MODEL
def test_goal_current_is_bounded_by_the_current_limit_on_both_sides(model: Model):
    if model.amperes is None:
        assert not {Register.CURRENT_LIMIT, Register.GOAL_CURRENT} & set(model.registers)
        return
    limit = model.factory_value(Register.CURRENT_LIMIT)
    assert model.factory_value(Register.GOAL_CURRENT) == limit
    assert model.allowed_range(Register.CURRENT_LIMIT) == (0, limit)
    assert model.allowed_range(Register.GOAL_CURRENT) == (-limit, limit)
