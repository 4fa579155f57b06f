"""Tuning constants of the search for key times."""

from dataclasses import dataclass

from kinesic.motion.infeasibility import DEFICIT_MARGIN


@dataclass(frozen=True)
class SearchTuning:
    """Tuning constants of the key-time search."""

    max_planes: int = 40  # cutting planes per key interval before key times are stretched
    max_evaluations: int = 150_000  # [knot intervals] measured before hinges stop at keys; a count is deterministic
    evaluated_duration: float = 15.0  # [s] motion length from which `max_evaluations` grows in proportion
    lp_cost_divisor: int = 400  # a linear program of n keys is charged n^2 / 400 knot intervals
    min_repeats: int = 2  # smallest number of repeated strokes stretched without trying cutting planes
    max_stretches: int = 6  # stretches per key interval before its hinge stops at both keys
    rest_growth: float = 1.1  # factor on a rest-to-rest duration that was too short
    max_rest_factor: float = 100.0  # total factor on a rest-to-rest duration before the search fails
    feasible_deficit: float = -DEFICIT_MARGIN / 4  # [ln(time ratio)] largest deficit of a feasible segment
    suspect_limit_ratio: float = 1.3  # estimated limit ratio above which a segment is measured exactly
    stretch_margin: float = 2.0  # [s] time before and after infeasible intervals that is stretched, too
    active_plane_slack: float = 0.02  # [ln(time ratio)] slack below which a cutting plane counts as active


SEARCH_TUNING = SearchTuning()  # tuning constants of every key-time search
