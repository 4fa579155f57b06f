"""First-order recursions along the rows of an array."""

from kinesic.body.arrays import Floats

NEGLIGIBLE_FACTOR = 1e-17  # weight below which an earlier row no longer changes a sum


def sum_decaying(values: Floats, factor: float) -> Floats:
    """Return the discounted running sums (m, ...) of values.

    sums[k] = values[k] + factor * sums[k - 1]. Each pass doubles the number of rows in the sums.

    Args:
        values: (m, ...).
        factor: weight of the previous sum, between -1 and 1.
    """
    sums, count, weight = values.copy(), 1, factor
    while count < len(sums) and abs(weight) > NEGLIGIBLE_FACTOR:
        sums[count:] += weight * sums[:-count]
        count, weight = 2 * count, weight**2
    return sums
