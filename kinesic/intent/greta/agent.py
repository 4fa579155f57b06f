"""How an agent of Greta moves: its baseline, and what an intention changes of it (qualifiers)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from types import MappingProxyType

from kinesic.bml.reading.tree import Element
from kinesic.body.config import ConfigError, suggestion
from kinesic.intent.greta.files import read_number, read_root

FIELDS = {  # of Greta -> of kinesic
    "SPC": "spatial",
    "TMP": "temporal",
    "FLD": "fluidity",
    "PWR": "power",
    "REP": "repetition",
}
UNBOUNDED = {"min": -inf, "max": inf}  # of a parameter whose bound is not written
EXPRESSED = frozenset({"gesture", "head", "face", "torso"})  # channels that have a manner in BML

Values = Mapping[str, Mapping[str, float]]  # modality -> `SPC.value` -> number


def _limited(value: float, least: float, most: float) -> float:
    return min(max(value, least), most)


OPERATORS: Mapping[str, Callable[[float, float, float, float], float]] = {  # of the value, two operands and intensity
    "ADD": lambda _, one, other, __: one + other,
    "SUB": lambda _, one, other, __: one - other,
    "VAL": lambda _, one, __, ___: one,
    "LIM": lambda value, one, other, _: _limited(value, one, other),
    "INTENSIFY": lambda _, one, __, intensity: one + (1.0 - one) * intensity,
}


@dataclass(frozen=True)
class Operand:
    """A number, or the name of one of the baseline."""

    value: float = 0.0
    modality: str = ""  # empty: it is the value
    parameter: str = ""

    def read(self, values: Values) -> float:
        """Finds the number."""
        usual = UNBOUNDED.get(self.parameter.rpartition(".")[2], 0.0)
        return values.get(self.modality, {}).get(self.parameter, usual) if self.modality else self.value


@dataclass(frozen=True)
class Modulation:
    """One step of a qualifier: a parameter becomes something else."""

    modality: str
    parameter: str
    operator: str
    first: Operand
    second: Operand


@dataclass(frozen=True, eq=False)
class Agent:
    """The expressivity of an agent by intention."""

    baseline: Values = field(default_factory=dict)
    qualifiers: Mapping[str, tuple[Modulation, ...]] = field(default_factory=dict)

    def manner(self, intent: str, channel: str, strength: float = 1.0) -> Mapping[str, float]:
        """Finds the expressivity of a channel while an intention is shown, by kinesic's names, -1 to 1.

        Args:
            intent: its name.
            channel: of the body.
            strength: 0..1 of the intention.
        """
        values = self._values(intent, strength).get(channel, {})
        if channel not in EXPRESSED:
            return {}
        known = {ours: values[f"{theirs}.value"] for theirs, ours in FIELDS.items() if f"{theirs}.value" in values}
        return {name: _limited(value, -1.0, 1.0) for name, value in known.items()}

    def share(self, intent: str, channel: str, name: str) -> float:
        """Finds `preference` or `OAC` of a channel, 0 to 1; 1 where nobody says."""
        return _limited(self._values(intent, 1.0).get(channel, {}).get(f"{name}.value", 1.0), 0.0, 1.0)

    def _values(self, intent: str, strength: float) -> Values:
        kind = f"{intent.partition('-')[0]}-*"
        names = {name.lower(): name for name in self.qualifiers}
        found = names.get(intent.lower()) or names.get(kind.lower())
        if found is None:
            return self.baseline
        values = {modality: dict(numbers) for modality, numbers in self.baseline.items()}
        for step in self.qualifiers[found]:
            own = values.setdefault(step.modality, {})
            first, second = step.first.read(values), step.second.read(values)
            own[step.parameter] = OPERATORS[step.operator](own.get(step.parameter, 0.0), first, second, strength)
        return values


def read_agent(baseline: Path | None, qualifiers: Path | None) -> Agent:
    """Reads a baseline and qualifiers.

    Raises:
        ConfigError: a file is missing or wrong.
    """
    return Agent(
        MappingProxyType({} if baseline is None else _baseline(baseline)),
        MappingProxyType({} if qualifiers is None else _qualifiers(qualifiers)),
    )


def _baseline(path: Path) -> dict[str, dict[str, float]]:
    """Numbers by modality and parameter; Greta writes `SPC.min` on its own, or `min` beside a value."""
    found: dict[str, dict[str, float]] = {}
    for group in read_root(path, "profile").children:
        numbers = found.setdefault(group.attributes.get("name", "").lower(), {})
        for each in group.children:
            name = each.attributes.get("name", "")
            for ending in ("value", "min", "max"):
                if ending in each.attributes:
                    key = name if "." in name else f"{name}.{ending}"
                    numbers[key] = read_number(each.attributes[ending], each, path)
    return found


def _qualifiers(path: Path) -> dict[str, tuple[Modulation, ...]]:
    elements = [each for each in read_root(path, "qualifiers").children if each.local == "qualifier"]
    return {
        each.attributes.get("name", ""): tuple(
            _modulation(step, path) for step in each.children if step.local == "modulation"
        )
        for each in elements
    }


def _modulation(element: Element, path: Path) -> Modulation:
    parts = {each.local: each for each in element.children}
    operator = parts["operator"].text.strip() if "operator" in parts else ""
    if operator not in OPERATORS:
        raise ConfigError(f"{path}:{element.place.line}: operator {operator!r}{suggestion(operator, list(OPERATORS))}")
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
