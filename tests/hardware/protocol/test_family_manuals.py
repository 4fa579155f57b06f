"""Control tables and factory settings of servo families, compared with the makers' memory tables.

The lists are written from the memory tables of Feetech and the e-Manual of ROBOTIS, not from the code.
"""

import pytest

from kinesic.hardware.protocol.frame_access import FrameAccess
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.native_models import NATIVE_SHEETS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.tables import FAMILY_TABLES, NativeField

from ...manual_servo.frame_device import AX, MX, SCS, STS, FrameDevice, FrameLine

FEETECH = """FIRMWARE_VERSION 0, MODEL_NUMBER 3 2, ID 5, BAUD_RATE 6, RETURN_DELAY_TIME 7, STATUS_RETURN_LEVEL 8,
MIN_POSITION_LIMIT 9 2, MAX_POSITION_LIMIT 11 2, TEMPERATURE_LIMIT 13, MAX_VOLTAGE_LIMIT 14, MIN_VOLTAGE_LIMIT 15,
PWM_LIMIT 16 2, SHUTDOWN 19, POSITION_P_GAIN 21, POSITION_D_GAIN 22, POSITION_I_GAIN 23, TORQUE_ENABLE 40,
GOAL_POSITION 42 2, PROFILE_VELOCITY 46 2, PRESENT_POSITION 56 2, PRESENT_VELOCITY 58 2, PRESENT_INPUT_VOLTAGE 62,
PRESENT_TEMPERATURE 63, HARDWARE_ERROR_STATUS 65, MOVING 66"""
PROTOCOL_1 = """MODEL_NUMBER 0 2, FIRMWARE_VERSION 2, ID 3, BAUD_RATE 4, RETURN_DELAY_TIME 5, MIN_POSITION_LIMIT 6 2,
MAX_POSITION_LIMIT 8 2, TEMPERATURE_LIMIT 11, MIN_VOLTAGE_LIMIT 12, MAX_VOLTAGE_LIMIT 13, PWM_LIMIT 14 2,
STATUS_RETURN_LEVEL 16, SHUTDOWN 18, TORQUE_ENABLE 24, LED 25, GOAL_POSITION 30 2, PROFILE_VELOCITY 32 2, GOAL_PWM 34 2,
PRESENT_POSITION 36 2, PRESENT_VELOCITY 38 2, PRESENT_CURRENT 40 2, PRESENT_INPUT_VOLTAGE 42, PRESENT_TEMPERATURE 43,
REGISTERED_INSTRUCTION 44, MOVING 46"""
OWN = {
    "sts": "CURRENT_LIMIT 28 2, HOMING_OFFSET 31 2, OPERATING_MODE 33, PROFILE_ACCELERATION 41, GOAL_PWM 48 2, "
    "PRESENT_CURRENT 69 2",
    "scs": "PRESENT_CURRENT 60 2",  # the load
    "ax": "",
    "mx": "POSITION_D_GAIN 26, POSITION_I_GAIN 27, POSITION_P_GAIN 28, PROFILE_ACCELERATION 73",
}
COMMON = {"sts": FEETECH, "scs": FEETECH, "ax": PROTOCOL_1, "mx": PROTOCOL_1}
SIGN_BITS = {  # bits of signs in numbers with a magnitude
    "sts": "HOMING_OFFSET 11, GOAL_POSITION 15, PROFILE_VELOCITY 15, PRESENT_POSITION 15, PRESENT_VELOCITY 15, "
    "PRESENT_CURRENT 15",
    "scs": "PRESENT_VELOCITY 15, PRESENT_CURRENT 10",
    "ax": "PRESENT_VELOCITY 10, PRESENT_CURRENT 10",
    "mx": "PRESENT_VELOCITY 10, PRESENT_CURRENT 10",
}
LOCKS = {"sts": 55, "scs": 48, "ax": None, "mx": None}  # addresses of the EEPROM lock
RAM_STARTS = {"sts": 40, "scs": 40, "ax": 24, "mx": 24}
BAUDS = {  # native code -> [bit/s], as far as sources agree
    "Feetech": {0: 1_000_000, 1: 500_000, 2: 250_000, 3: 128_000, 4: 115_200},
    "Dynamixel": {1: 1_000_000, 3: 500_000, 7: 250_000, 16: 115_200, 34: 57_600, 103: 19_200, 207: 9_600},
}
# name: model number, supply [0.1 V], temperature limit [C], no-load velocity [rev/min], P, I and D gain
SHEETS = {
    "sts3215_12v": (777, (40, 140), 70, 45, (32, 0, 32)),
    "sts3215": (777, (40, 80), 70, 55.4, (32, 0, 32)),
    "sts3250": (2825, (60, 140), 70, 75, (32, 0, 32)),
    "sm8512bl": (11272, (90, 260), 70, 45, (32, 0, 32)),
    "scs0009": (1284, (40, 75), 80, 111, (15, 0, 0)),
    "ax12": (12, (60, 140), 70, 59, (0, 0, 0)),
    "ax18": (18, (60, 140), 75, 97, (0, 0, 0)),
    "mx28": (29, (60, 160), 80, 55, (32, 0, 0)),
    "mx64": (310, (60, 160), 80, 63, (32, 0, 0)),
    "mx106": (320, (60, 160), 80, 45, (32, 0, 0)),
}
LAYOUTS = {"sts3215": (STS, 74), "scs0009": (SCS, 60), "ax12": (AX, 120), "mx28": (MX, 120)}  # layout, [0.1 V]


def entries(text: str) -> dict[Register, list[int]]:
    rows = [row.split() for row in text.replace("\n", " ").split(",") if row.strip()]
    return {Register[name]: [int(number) for number in numbers] for name, *numbers in rows}


@pytest.mark.parametrize("family", list(FAMILY_TABLES))
def test_every_register_of_a_family_has_the_address_and_size_of_the_memory_table(family: str):
    manual = entries(COMMON[family]) | entries(OWN[family])
    table = FAMILY_TABLES[family]
    assert {register: (field.address, field.size) for register, field in table.fields.items()} == {
        register: (numbers[0], numbers[1] if len(numbers) > 1 else 1) for register, numbers in manual.items()
    }
    assert {register: field.sign_bit for register, field in table.fields.items() if field.sign_bit is not None} == {
        register: bit for register, (bit,) in entries(SIGN_BITS[family]).items()
    }
    assert (table.lock, table.ram_start) == (LOCKS[family], RAM_STARTS[family])
    assert table.bauds == BAUDS[table.maker]
    assert [table.baud_code(rate) for rate in table.bauds.values()] == list(table.bauds)
    assert table.baud_code(123) is None


@pytest.mark.parametrize(
    ("family", "register", "native", "value"),
    [
        ("sts", Register.PROFILE_ACCELERATION, 254, 254 * 100 / 4096 * 3600 / 214.577),  # 100 steps/s^2
        ("sts", Register.PROFILE_VELOCITY, 1000, 1000 / 4096 * 60 / 0.229),  # steps/s
        ("sts", Register.GOAL_PWM, 1000, 885),  # full duty
        ("sts", Register.PWM_LIMIT, 500, 442.5),
        ("scs", Register.PROFILE_VELOCITY, 500, 500 * 300 / 1023 / 360 * 60 / 0.229),  # counts/s
        ("scs", Register.PRESENT_POSITION, 512, 2048),
        ("scs", Register.PRESENT_POSITION, 512 + 341, 2048 + 100 / 360 * 4096),
        ("ax", Register.PROFILE_VELOCITY, 500, 55.5 / 0.229),
        ("ax", Register.GOAL_PWM, 1023, 885),
        ("ax", Register.PRESENT_CURRENT, 1023, 1000),
        ("ax", Register.GOAL_POSITION, 0, 2048 - 150.15 / 360 * 4096),
        ("mx", Register.PROFILE_VELOCITY, 500, 57.0 / 0.229),
        ("mx", Register.PROFILE_ACCELERATION, 100, 100 * 8.583 * 10 / 214.577),  # 8.583 deg/s^2
        ("mx", Register.PRESENT_INPUT_VOLTAGE, 120, 120),
    ],
)
def test_native_numbers_convert_by_the_units_of_the_manuals(family: str, register: Register, native: int, value: float):
    assert FAMILY_TABLES[family].fields[register].from_native(native) == pytest.approx(value, abs=0.51)


def test_factory_settings_of_every_model_are_those_of_its_data_sheet():
    assert [sheet.name for sheet in NATIVE_SHEETS] == list(SHEETS)
    for sheet in NATIVE_SHEETS:
        number, (lowest, highest), heat, rpm, gains = SHEETS[sheet.name]
        initial = sheet.initial
        assert initial[Register.MODEL_NUMBER] == number, sheet.name
        assert (initial[Register.MIN_VOLTAGE_LIMIT], initial[Register.MAX_VOLTAGE_LIMIT]) == (lowest, highest)
        assert initial[Register.TEMPERATURE_LIMIT] == heat
        assert initial[Register.VELOCITY_LIMIT] * 0.229 == pytest.approx(1.2 * rpm, abs=0.12)
        names = (Register.POSITION_P_GAIN, Register.POSITION_I_GAIN, Register.POSITION_D_GAIN)
        assert tuple(initial[name] for name in names) == gains
        assert initial[Register.SHUTDOWN] == (0x24 if sheet.name.startswith(("ax", "mx")) else 0x3C)
        assert (initial[Register.GOAL_POSITION], initial[Register.PWM_LIMIT]) == (2048, 885)
        assert initial[Register.RETURN_DELAY_TIME] == 250
        is_wide = sheet.name.startswith(("sts", "sm", "mx"))
        assert sheet.position_range == ((0, 4095) if is_wide else (340, 3753)), sheet.name
        assert sheet.ranges[Register.GOAL_POSITION] == sheet.position_range
        assert sheet.ranges[Register.MIN_VOLTAGE_LIMIT] == sheet.ranges[Register.MAX_VOLTAGE_LIMIT] == (lowest, highest)
        assert sheet.ranges[Register.BAUD_RATE] == (0, max(BAUDS[sheet.table.maker]))
        has_sensor = sheet.name.startswith(("sts", "sm"))
        assert sheet.amperes == (0.0065 if has_sensor else None)
        assert (Register.CURRENT_LIMIT in initial, Register.GOAL_CURRENT in initial) == (has_sensor, has_sensor)


@pytest.mark.parametrize("name", list(LAYOUTS))
def test_registers_of_an_independently_written_servo_are_read_in_the_layout_of_the_x_series(name: str):
    layout, volts = LAYOUTS[name]
    device = FrameDevice(layout, SERVO_MODELS[name].number, 3, volts=volts)
    device.table[layout.celsius] = 41
    image = FrameAccess(FrameLine([device])).read_table(3)

    def read(register: Register) -> int:
        field = register.field
        return int.from_bytes(image[field.address : field.address + field.size], "little", signed=field.signed)

    assert read(Register.MODEL_NUMBER) == device.number
    assert read(Register.ID) == 3
    assert read(Register.TEMPERATURE_LIMIT) == 70
    assert read(Register.PRESENT_TEMPERATURE) == 41
    assert (read(Register.MIN_VOLTAGE_LIMIT), read(Register.MAX_VOLTAGE_LIMIT)) == (volts - 25, volts + 30)
    assert read(Register.GOAL_POSITION) == 2048
    assert read(Register.PWM_LIMIT) == 885
    assert read(Register.STATUS_RETURN_LEVEL) == 2
    assert len(image) == 147


@pytest.mark.parametrize("name", list(LAYOUTS))
def test_all_servos_on_a_wire_answer_a_broadcast_ping_with_their_models(name: str):
    layout, volts = LAYOUTS[name]
    devices = [FrameDevice(layout, SERVO_MODELS[name].number, k, volts=volts) for k in (9, 2, 5)]
    replies = FrameAccess(FrameLine(devices)).ping_all()
    assert [reply.id for reply in replies] == [2, 5, 9]
    assert {reply.name for reply in replies} == {name}
    assert FrameAccess(FrameLine([])).ping_all() == ()


def test_largest_position_of_a_servo_with_1023_counts_is_its_count_1023():
    for name in ("ax12", "ax18", "scs0009"):
        lowest, highest = SERVO_MODELS[name].allowed_range(Register.GOAL_POSITION)
        field = SERVO_MODELS[name].native_table.fields[Register.GOAL_POSITION]
        assert (field.to_native(lowest), field.to_native(highest)) == (0, 1023)


def test_numbers_beyond_the_bits_of_a_register_are_cut_to_its_range():
    plain, signed = NativeField(0, 1), NativeField(0, 2, sign_bit=10)
    assert [plain.to_native(value) for value in (-5, 0, 255, 256)] == [0, 0, 255, 255]
    assert [signed.to_native(value) for value in (-1024, -1023, 1023, 1024)] == [-1023, -1023, 1023, 1023]
    assert signed.pack(-5, order="little") == bytes([5, 4])
    assert signed.unpack(bytes([5, 4]), order="little") == -5
    assert signed.unpack(bytes([5, 0x88]), order="little") == 5, "bits above the sign are ignored"
