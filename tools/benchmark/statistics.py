"""Medians, intervals and tests. The standard library alone."""

import math
from statistics import median


def ratio_interval(ratios):
    """(low, high, coverage) of the median of paired ratios: the widest pair of order statistics.

    The smallest and the largest of n miss the median with a chance of 2 · 2⁻ⁿ, whatever the distribution; from eight
    on the next pair inside is taken while it covers at least 95%.
    """
    ordered, n = sorted(ratios), len(ratios)
    inside = 0
    while coverage(n, inside + 1) >= 0.95:
        inside += 1
    return ordered[inside], ordered[n - 1 - inside], coverage(n, inside)


def coverage(n, inside):
    """Chance that the median lies between the order statistics inside + 1 and n − inside of n."""
    if 2 * inside >= n:
        return 0.0
    return 1 - 2 * sum(math.comb(n, k) for k in range(inside + 1)) / 2**n


def summary(ratios):
    """The median of paired ratios and its interval, for a report."""
    low, high, covers = ratio_interval(ratios)
    return {"median": median(ratios), "low": low, "high": high, "coverage": covers, "rounds": list(ratios)}


def student_p(t, freedom):
    """Two-sided p-value of Student's t."""
    return incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t))


def incomplete_beta(a, b, x):
    """The regularised incomplete beta function, by its continued fraction (Lentz)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - incomplete_beta(b, a, 1 - x)
    log_front = a * math.log(x) + b * math.log1p(-x) + math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    return math.exp(log_front) / a * beta_fraction(a, b, x)


def beta_fraction(a, b, x):
    tiny = 1e-300
    c, d = 1.0, 1 / (1 - (a + b) * x / (a + 1) or tiny)
    value = d
    for m in range(1, 500):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for step in (even, odd):
            d = 1 / (1 + step * d or tiny)
            c = 1 + step / c or tiny
            value *= c * d
        if abs(c * d - 1) < 1e-15:
            break
    return value


def student_quantile(p, freedom):
    """The t whose two-sided p-value is p."""
    low, high = 0.0, 1e9
    for _ in range(200):
        middle = (low + high) / 2
        if student_p(middle, freedom) > p:
            low = middle
        else:
            high = middle
    return high


def power_law(x, y):
    """The exponent k of the least-squares fit y = c xᵏ."""
    u, v = [math.log(a) for a in x], [math.log(a) for a in y]
    mean_u, mean_v = sum(u) / len(u), sum(v) / len(v)
    spread = sum((a - mean_u) ** 2 for a in u)
    return sum((a - mean_u) * (b - mean_v) for a, b in zip(u, v)) / spread
