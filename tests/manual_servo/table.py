"""Control table of each X series model, from the manufacturer's manual."""

from dataclasses import dataclass

ANY_VALUE = None  # bounds of a register that accepts every value of its size


@dataclass(frozen=True)
class Item:
    """Description of one register."""

    address: int
    size: int
    initial: int
    bounds: tuple[int, int] | None = ANY_VALUE
    writable: bool = True
    signed: bool = False

    @property
    def lasting(self) -> bool:
        """Return whether the register is in EEPROM."""
        return self.address < 64


@dataclass(frozen=True)
class Model:
    """Properties of one model."""

    number: int
    stall: float  # [Nm] stall torque at 12 V
    no_load: float  # [rad/s] no-load velocity
    amperes: float | None  # [A] current per count of Present Current; None: the register shows the load
    current_limit: int
    speed_limit: int  # [0.229 rpm] velocity limit
    gains: tuple[int, int, int]  # position gains P, I, D
    celsius: int  # [C] temperature limit
    volts: tuple[int, int]  # [0.1 V] minimum and maximum voltage
    inertia: float  # [kg m^2] at the shaft
    cells: int = 28
    windows: tuple[tuple[int, int], ...] = (
        (168, 224),
        (578, 634),
    )  # addresses of the first indirect address and the first indirect data
    rated: float = 12.0  # [V] rated voltage
    fast: int = 45  # first firmware version with fast reads
    ports: bool = False  # whether the model has external ports
    inner: tuple[int, int] = (1920, 100)  # velocity gains I, P

    @property
    def modes(self) -> tuple[int, ...]:
        """Return the operating modes of the model."""
        return (1, 3, 4, 16) if self.amperes is None else (0, 1, 3, 4, 5, 16)

    @property
    def end(self) -> int:
        """Return the address behind the last register."""
        return self.windows[-1][1] + self.cells


SERIES_330 = {"cells": 20, "windows": ((168, 208),), "fast": 46}  # properties that all models of the 330 series share
MODELS = {
    "xm430_w210": Model(1030, 3.0, 8.06, 0.00269, 1193, 330, (800, 0, 0), 80, (95, 160), 0.0163),
    "xm430_w350": Model(1020, 4.1, 4.82, 0.00269, 1193, 350, (800, 0, 0), 80, (95, 160), 0.03),
    "xm540_w150": Model(1130, 7.3, 5.55, 0.00269, 2047, 230, (800, 0, 0), 80, (95, 160), 0.031, ports=True),
    "xm540_w270": Model(1120, 10.6, 3.14, 0.00269, 2047, 128, (800, 0, 0), 80, (95, 160), 0.1, ports=True),
    "xl430_w250": Model(1060, 1.4, 5.97, None, 0, 265, (640, 0, 4000), 72, (60, 140), 0.008),
    "xl330_m288": Model(1200, 0.52, 10.8, 0.001, 1750, 445, (400, 0, 0), 70, (35, 70), 0.0008, rated=5.0, **SERIES_330),
    "xc430_w240": Model(1080, 1.9, 7.33, None, 0, 306, (700, 0, 0), 80, (60, 160), 0.01),
    "xc330_t288": Model(
        1220, 1.0, 7.43, 0.001, 910, 320, (900, 0, 0), 70, (55, 140), 0.0018, inner=(1200, 40), **SERIES_330
    ),
}

GOAL_REGISTERS = ("goal_pwm", "goal_current", "goal_velocity", "goal_position")


def items(model: Model, servo: int, firmware: int) -> dict[str, Item]:
    """Return a model's registers by name with their factory values."""
    low, high = model.volts
    registers = {
        "model": Item(0, 2, model.number, writable=False),
        "model_information": Item(2, 4, 0, writable=False),
        "firmware": Item(6, 1, firmware, writable=False),
        "id": Item(7, 1, servo, (0, 252)),
        "baud": Item(8, 1, 1, (0, 6 if model.cells == 20 else 7)),
        "return_delay": Item(9, 1, 250, (0, 254)),
        "drive_mode": Item(10, 1, 0, (0, 15)),
        "operating_mode": Item(11, 1, 3, (0, 16)),
        "secondary_id": Item(12, 1, 255),
        "protocol": Item(13, 1, 2, (2, 22) if model.cells == 20 else (1, 2)),
        "homing_offset": Item(20, 4, 0, (-1_044_479, 1_044_479), signed=True),
        "moving_threshold": Item(24, 4, 10, (0, 1023)),
        "temperature_limit": Item(31, 1, model.celsius, (0, 100)),
        "max_voltage": Item(32, 2, high, (low, high)),
        "min_voltage": Item(34, 2, low, (low, high)),
        "pwm_limit": Item(36, 2, 885, (0, 885)),
        "current_limit": Item(38, 2, model.current_limit, (0, model.current_limit)),
        "velocity_limit": Item(44, 4, model.speed_limit, (0, 2047 if model.cells == 20 else 1023)),
        "max_position": Item(48, 4, 4095, (0, 4095)),
        "min_position": Item(52, 4, 0, (0, 4095)),
        "startup": Item(60, 1, 0, (0, 3)),
        "shutdown": Item(63, 1, 52, (0, 63)),
        "torque": Item(64, 1, 0, (0, 1)),
        "led": Item(65, 1, 0, (0, 1)),
        "status_return": Item(68, 1, 2, (0, 2)),
        "registered": Item(69, 1, 0, writable=False),
        "error": Item(70, 1, 0, writable=False),
        "velocity_i": Item(76, 2, model.inner[0], (0, 16383)),
        "velocity_p": Item(78, 2, model.inner[1], (0, 16383)),
        "position_d": Item(80, 2, model.gains[2], (0, 16383)),
        "position_i": Item(82, 2, model.gains[1], (0, 16383)),
        "position_p": Item(84, 2, model.gains[0], (0, 16383)),
        "feed_forward_2": Item(88, 2, 0, (0, 16383)),
        "feed_forward_1": Item(90, 2, 0, (0, 16383)),
        "watchdog": Item(98, 1, 0, (0, 127), signed=True),
        "goal_pwm": Item(100, 2, 885, ANY_VALUE, signed=True),
        "goal_current": Item(102, 2, model.current_limit, ANY_VALUE, signed=True),
        "goal_velocity": Item(104, 4, 0, ANY_VALUE, signed=True),
        "profile_acceleration": Item(108, 4, 0, (0, 32767)),
        "profile_velocity": Item(112, 4, 0, (0, 32767)),
        "goal_position": Item(116, 4, 0, ANY_VALUE, signed=True),
        "tick": Item(120, 2, 0, writable=False),
        "moving": Item(122, 1, 0, writable=False),
        "moving_status": Item(123, 1, 0, writable=False),
        "present_pwm": Item(124, 2, 0, writable=False, signed=True),
        "present_current": Item(126, 2, 0, writable=False, signed=True),
        "present_velocity": Item(128, 4, 0, writable=False, signed=True),
        "present_position": Item(132, 4, 0, writable=False, signed=True),
        "velocity_trajectory": Item(136, 4, 0, writable=False, signed=True),
        "position_trajectory": Item(140, 4, 0, writable=False, signed=True),
        "volts": Item(144, 2, round(10 * model.rated), writable=False),
        "celsius": Item(146, 1, 25, writable=False),
        "backup_ready": Item(147, 1, 0, writable=False),
    }
    if model.cells == 20:
        registers["pwm_slope"] = Item(62, 1, 140 if model.rated < 12 else 255, (1, 255))
    if model.ports:
        registers |= {f"port_mode_{k + 1}": Item(56 + k, 1, 3, (0, 3)) for k in range(3)}
        registers |= {f"port_data_{k + 1}": Item(152 + 2 * k, 2, 0, (0, 4095)) for k in range(3)}
    if model.amperes is None:  # no current sensor: its Present Current is a Present Load
        del registers["current_limit"], registers["goal_current"]
    return registers
