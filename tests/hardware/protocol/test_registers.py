from itertools import pairwise

import pytest

from kinesic.body.config import CONFIGS
from kinesic.body.robot_file import servo_models
from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, SERVO_MODELS, UNREACHABLE_FIRMWARE, Model
from kinesic.hardware.protocol.registers import BAUD_RATES, HardwareError, Mode, Register

X_SERIES = pytest.mark.parametrize("model", [model for model in SERVO_MODELS.values() if model.table is None])
EVERY_MODEL = pytest.mark.parametrize("model", SERVO_MODELS.values(), ids=list(SERVO_MODELS))
MODEL_NUMBERS = {
    "xl330_m077": 1190,
    "xl330_m288": 1200,
    "xc330_t181": 1210,
    "xc330_t288": 1220,
    "xc330_m181": 1230,
    "xc330_m288": 1240,
    "xl430_w250": 1060,
    "2xl430_w250": 1090,
    "xc430_w150": 1070,
    "xc430_w240": 1080,
    "xm430_w350": 1020,
    "xm430_w210": 1030,
    "xh430_w350": 1000,
    "xh430_w210": 1010,
    "xm540_w270": 1120,
    "xm540_w150": 1130,
    "xh540_w270": 1100,
    "xh540_w150": 1110,
    "xw540_t260": 1170,
}


def test_registers_of_a_servo_do_not_overlap():
    fields = sorted((register.field for register in Register), key=lambda field: field.address)
    for one, next_one in pairwise(fields):
        assert one.end <= next_one.address


def test_register_addresses_of_a_servo_are_unique():
    assert len(Register) == len(Register.__members__)
    assert len({register.field.address for register in Register}) == len(Register)


def test_register_sizes_are_one_two_or_four_bytes():
    assert {register.field.size for register in Register} == {1, 2, 4}


def test_factory_values_and_limits_fit_into_their_registers():
    for model in SERVO_MODELS.values():
        for register in model.registers:
            lower, upper = model.allowed_range(register)
            assert lower <= upper
            for value in (model.factory_value(register), lower, upper):
                assert register.field.unpack(register.field.pack(value)) == value


@EVERY_MODEL
def test_factory_register_values_are_within_their_ranges(model: Model):
    for register in model.registers:
        lower, upper = model.allowed_range(register)
        if register.field.writable:
            assert lower <= model.factory_value(register) <= upper


@pytest.mark.parametrize(
    "register",
    [
        Register.MODEL_NUMBER,
        Register.MODEL_INFORMATION,
        Register.FIRMWARE_VERSION,
        Register.REGISTERED_INSTRUCTION,
        Register.HARDWARE_ERROR_STATUS,
        Register.REALTIME_TICK,
        Register.MOVING,
        Register.MOVING_STATUS,
        Register.PRESENT_PWM,
        Register.PRESENT_CURRENT,
        Register.PRESENT_VELOCITY,
        Register.PRESENT_POSITION,
        Register.VELOCITY_TRAJECTORY,
        Register.POSITION_TRAJECTORY,
        Register.PRESENT_INPUT_VOLTAGE,
        Register.PRESENT_TEMPERATURE,
        Register.BACKUP_READY,
    ],
)
def test_sensor_registers_are_read_only(register: Register):
    assert not register.field.writable
    assert sum(not other.field.writable for other in Register) == 17


def test_eeprom_registers_end_before_the_register_torque_enable():
    assert Register.SHUTDOWN.field.eeprom
    assert not Register.TORQUE_ENABLE.field.eeprom


@pytest.mark.parametrize(
    ("register", "address", "size", "signed"),
    [
        (Register.ID, 7, 1, False),
        (Register.OPERATING_MODE, 11, 1, False),
        (Register.HOMING_OFFSET, 20, 4, True),
        (Register.CURRENT_LIMIT, 38, 2, False),
        (Register.TORQUE_ENABLE, 64, 1, False),
        (Register.BUS_WATCHDOG, 98, 1, True),
        (Register.GOAL_CURRENT, 102, 2, True),
        (Register.PROFILE_ACCELERATION, 108, 4, False),
        (Register.GOAL_POSITION, 116, 4, True),
        (Register.PRESENT_CURRENT, 126, 2, True),
        (Register.PRESENT_POSITION, 132, 4, True),
        (Register.PRESENT_INPUT_VOLTAGE, 144, 2, False),
        (Register.PRESENT_TEMPERATURE, 146, 1, False),
    ],
)
def test_register_addresses_match_the_manual(register: Register, address: int, size: int, signed: bool):
    field = register.field
    assert (field.address, field.size, field.signed) == (address, size, signed)


def test_register_units_match_the_manual():
    assert Register.PRESENT_VELOCITY.field.scale == pytest.approx(0.229 * 6.283185307 / 60)
    assert Register.PRESENT_INPUT_VOLTAGE.field.scale == pytest.approx(0.1)
    assert Register.BUS_WATCHDOG.field.scale == pytest.approx(0.020)
    assert 4096 * Register.GOAL_POSITION.field.scale == pytest.approx(6.283185307)
    assert 885 * Register.GOAL_PWM.field.scale == pytest.approx(1.0)


def test_register_rejects_values_that_exceed_its_size():
    with pytest.raises(ValueError, match="does not fit into an unsigned register of 1 bytes at 64"):
        Register.TORQUE_ENABLE.field.pack(300)
    with pytest.raises(ValueError, match="has 4 bytes, not 2"):
        Register.GOAL_POSITION.field.unpack(b"\0\0")


def test_negative_register_values_are_twos_complement():
    assert Register.GOAL_POSITION.field.pack(-1) == b"\xff\xff\xff\xff"
    assert Register.BUS_WATCHDOG.field.unpack(b"\xff") == -1


def test_model_numbers_match_the_manual_and_are_unique():
    numbers = {name: model.number for name, model in SERVO_MODELS.items()}
    assert {name: numbers[name] for name in MODEL_NUMBERS} == MODEL_NUMBERS
    unlisted = {name for name, model in SERVO_MODELS.items() if model.table is None} - set(MODEL_NUMBERS)
    assert not unlisted, f"add {unlisted} to MODEL_NUMBERS above, from the manual"
    versions = {"sts3215_12v"}  # of one model for another supply voltage
    names = {model.name for model in MODELS_BY_NUMBER.values()}
    assert names == set(SERVO_MODELS) - versions, "two models have the same number"


def test_model_numbers_match_the_servo_table():
    servos = servo_models()
    assert servos, CONFIGS
    for name, servo in servos.items():
        assert name in SERVO_MODELS, f"add a FactorySheet of {name} to kinesic/hardware/protocol/x_series.py"
        assert SERVO_MODELS[name].number == servo.model, (
            f"{name}: kinesic/configs/servos.toml and kinesic/hardware/protocol differ"
        )


@pytest.mark.parametrize(
    ("name", "register", "initial", "span"),
    [
        ("xl330_m288", Register.TEMPERATURE_LIMIT, 70, (0, 100)),
        ("xl330_m288", Register.MIN_VOLTAGE_LIMIT, 35, (31, 70)),
        ("xl330_m288", Register.CURRENT_LIMIT, 1750, (0, 1750)),
        ("xl330_m288", Register.VELOCITY_LIMIT, 445, (0, 2047)),
        ("xl330_m288", Register.SHUTDOWN, 53, (0, 63)),
        ("xl330_m288", Register.BAUD_RATE, 1, (0, 6)),
        ("xc330_t288", Register.MAX_VOLTAGE_LIMIT, 140, (55, 140)),
        ("xc330_t288", Register.POSITION_P_GAIN, 900, (0, 16383)),
        ("xl430_w250", Register.POSITION_D_GAIN, 4000, (0, 16383)),
        ("xl430_w250", Register.TEMPERATURE_LIMIT, 72, (0, 100)),
        ("xm430_w350", Register.CURRENT_LIMIT, 1193, (0, 1193)),
        ("xm430_w350", Register.GOAL_CURRENT, 1193, (-1193, 1193)),
        ("xm540_w270", Register.VELOCITY_LIMIT, 128, (0, 1023)),
        ("xm540_w270", Register.MIN_VOLTAGE_LIMIT, 95, (95, 160)),
        ("xh540_w270", Register.POSITION_P_GAIN, 800, (0, 16383)),
    ],
)
def test_register_values_match_the_manual(name: str, register: Register, initial: int, span: tuple[int, int]):
    assert SERVO_MODELS[name].factory_value(register) == initial
    assert SERVO_MODELS[name].allowed_range(register) == span


def test_servo_without_current_sensor_lacks_current_modes():
    model = SERVO_MODELS["xl430_w250"]
    assert model.amperes is None
    assert not model.has(Register.CURRENT_LIMIT)
    assert not model.has(Register.GOAL_CURRENT)
    assert model.modes == {Mode.VELOCITY, Mode.POSITION, Mode.EXTENDED_POSITION, Mode.PWM}
    assert SERVO_MODELS["xm430_w350"].amperes == pytest.approx(2.69e-3)
    assert SERVO_MODELS["xl330_m288"].amperes == pytest.approx(1e-3)


def test_optional_registers_differ_between_servo_models():
    assert SERVO_MODELS["xm540_w270"].has(Register.EXTERNAL_PORT_MODE_1)
    assert not SERVO_MODELS["xm430_w350"].has(Register.EXTERNAL_PORT_MODE_1)
    assert SERVO_MODELS["xl330_m288"].has(Register.PWM_SLOPE)
    assert not SERVO_MODELS["xw540_t260"].has(Register.LED)


@EVERY_MODEL
def test_indirect_cells_follow_all_other_registers(model: Model):
    end = max(register.field.end for register in model.registers)
    for cells in model.cells:
        assert cells.addresses >= end
        assert cells.data >= cells.addresses + 2 * cells.count


def test_first_firmware_with_fast_reads_matches_the_manual():
    assert SERVO_MODELS["xl330_m288"].fast_firmware == 46
    assert SERVO_MODELS["xm430_w350"].fast_firmware == 45
    assert SERVO_MODELS["2xl430_w250"].fast_firmware == UNREACHABLE_FIRMWARE


def test_baud_rate_values_match_the_manual():
    assert BAUD_RATES[1] == 57_600
    assert BAUD_RATES[3] == 1_000_000
    assert BAUD_RATES[6] == 4_000_000


@pytest.mark.parametrize(
    ("bits", "names"),
    [
        (0, ()),
        (0x01, ("voltage",)),
        (0x30, ("electrical shock", "overload")),
        (0x3D, ("voltage", "overheating", "encoder", "electrical shock", "overload")),
    ],
)
def test_hardware_errors_are_named_by_their_bits(bits: int, names: tuple[str, ...]):
    assert HardwareError.names(bits) == names


@X_SERIES
def test_factory_shutdown_mask_includes_the_voltage_only_for_five_volt_models(model: Model):
    is_five_volt = model.name.startswith("xl330")
    assert model.initial[Register.SHUTDOWN] == (53 if is_five_volt else 52)
