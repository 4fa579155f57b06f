"""Expressivity of a Greta agent: baseline and qualifiers per intention."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from types import MappingProxyType

from kinesic.bml.reading.tree import Element
from kinesic.body.config import ConfigError, suggestion
from kinesic.intent.greta.files import read_number, read_root

PARAMETER_NAMES = {  # name in Greta -> name in kinesic
    "SPC": "spatial",
    "TMP": "temporal",
    "FLD": "fluidity",
    "PWR": "power",
    "REP": "repetition",
}
DEFAULT_BOUNDS = {"min": -inf, "max": inf}  # limits of a parameter without bounds
EXPRESSIVE_CHANNELS = frozenset({"gesture", "head", "face", "torso"})  # channels with expressivity in BML

Values = Mapping[str, Mapping[str, float]]  # modality -> `SPC.value` -> number


def _clip(value: float, least: float, most: float) -> float:
    return min(max(value, least), most)


MODULATION_OPERATORS: Mapping[
    str, Callable[[float, float, float, float], float]
] = {  # operator -> function of value, first and second operand, intensity
    "ADD": lambda _, one, other, __: one + other,
    "SUB": lambda _, one, other, __: one - other,
    "VAL": lambda _, one, __, ___: one,
    "LIM": lambda value, one, other, _: _clip(value, one, other),
    "INTENSIFY": lambda _, one, __, intensity: one + (1.0 - one) * intensity,
}


@dataclass(frozen=True)
class Operand:
    """Number, or reference to a parameter of Greta's baseline."""

    value: float = 0.0
    modality: str = ""  # modality of the parameter; empty: the operand is `value`
    parameter: str = ""

    def read(self, values: Values) -> float:
        """Return the operand's number, or its parameter's value."""
        default = DEFAULT_BOUNDS.get(self.parameter.rpartition(".")[2], 0.0)
        return values.get(self.modality, {}).get(self.parameter, default) if self.modality else self.value


@dataclass(frozen=True)
class Modulation:
    """Step of a Greta qualifier that computes and sets one parameter."""

    modality: str
    parameter: str
    operator: str
    first: Operand
    second: Operand


@dataclass(frozen=True, eq=False)
class Agent:
    """Expressivity and channel preferences of a Greta agent, by intention."""

    baseline: Values = field(default_factory=dict)
    qualifiers: Mapping[str, tuple[Modulation, ...]] = field(default_factory=dict)

    def manner(self, intent: str, channel: str, strength: float = 1.0) -> Mapping[str, float]:
        """Return a body channel's expressivity parameters for an intention, -1 to 1.

        The keys are the parameter names of kinesic.

        Args:
            intent: its name.
            channel: of the body.
            strength: 0..1 of the intention.
        """
        values = self._values(intent, strength).get(channel, {})
        if channel not in EXPRESSIVE_CHANNELS:
            return {}
        parameters = {
            name_here: values[f"{name_in_greta}.value"]
            for name_in_greta, name_here in PARAMETER_NAMES.items()
            if f"{name_in_greta}.value" in values
        }
        return {name: _clip(value, -1.0, 1.0) for name, value in parameters.items()}

    def weight(self, intent: str, channel: str, name: str) -> float:
        """Return Greta's weight `preference` or `OAC` of a channel, 0..1.

        `preference` is a factor on the certainty, `OAC` one on the probability of signals that are not core. The
        default is 1.
        """
        return _clip(self._values(intent, 1.0).get(channel, {}).get(f"{name}.value", 1.0), 0.0, 1.0)

    def _values(self, intent: str, strength: float) -> Values:
        if not self.qualifiers:
            return self.baseline
        kind = f"{intent.partition('-')[0]}-*"
        names = {name.lower(): name for name in self.qualifiers}
        qualifier = names.get(intent.lower()) or names.get(kind.lower())
        if qualifier is None:
            return self.baseline
        values = {modality: dict(numbers) for modality, numbers in self.baseline.items()}
        for step in self.qualifiers[qualifier]:
            parameters = values.setdefault(step.modality, {})
            first, second = step.first.read(values), step.second.read(values)
            parameters[step.parameter] = MODULATION_OPERATORS[step.operator](
                parameters.get(step.parameter, 0.0), first, second, strength
            )
        return values


def read_agent(baseline: Path | None, qualifiers: Path | None) -> Agent:
    """Read the baseline and qualifier files of a Greta agent.

    Raises:
        ConfigError: a file is missing or invalid.
    """
    return Agent(
        MappingProxyType({} if baseline is None else _read_baseline(baseline)),
        MappingProxyType({} if qualifiers is None else _qualifiers(qualifiers)),
    )


def _read_baseline(path: Path) -> dict[str, dict[str, float]]:
    """Return Greta's baseline values by modality and parameter.

    Greta writes `SPC.min` separately, or `min` with a value.
    """
    qualifier: dict[str, dict[str, float]] = {}
    for group in read_root(path, "profile").children:
        numbers = qualifier.setdefault(group.attributes.get("name", "").lower(), {})
        for parameter in group.children:
            name = parameter.attributes.get("name", "")
            for ending in ("value", "min", "max"):
                if ending in parameter.attributes:
                    key = name if "." in name else f"{name}.{ending}"
                    numbers[key] = read_number(parameter.attributes[ending], parameter, path)
    return qualifier


def _qualifiers(path: Path) -> dict[str, tuple[Modulation, ...]]:
    elements = [qualifier for qualifier in read_root(path, "qualifiers").children if qualifier.local == "qualifier"]
    return {
        qualifier.attributes.get("name", ""): tuple(
            _modulation(step, path) for step in qualifier.children if step.local == "modulation"
        )
        for qualifier in elements
    }


def _modulation(element: Element, path: Path) -> Modulation:
    parts = {child.local: child for child in element.children}
    operator = parts["operator"].text.strip() if "operator" in parts else ""
    if operator not in MODULATION_OPERATORS:
        raise ConfigError(
            f"{path}:{element.place.line}: operator {operator!r}{suggestion(operator, list(MODULATION_OPERATORS))}"
        )
    missing = {"destination", "parameter"} - set(parts)
    if missing:
        raise ConfigError(f"{path}:{element.place.line}: <modulation> has no <{min(missing)}>")
    return Modulation(
        parts["destination"].text.strip().lower(),
        parts["parameter"].text.strip(),
        operator,
        _operand(parts, "op1", path),
        _operand(parts, "op2", path),
    )


def _operand(parts: Mapping[str, Element], name: str, path: Path) -> Operand:
    value, modality, parameter = (parts.get(f"{name}_{part}") for part in ("value", "name", "attribute"))
    if modality is not None and parameter is not None:
        return Operand(0.0, modality.text.strip().lower(), parameter.text.strip())
    return Operand(0.0 if value is None else read_number(value.text.strip(), value, path))
