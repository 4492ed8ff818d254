"""A number with what is known of it."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, inf, isfinite, log10, nan
from typing import Any


@dataclass(frozen=True)
class Estimate:
    """A parameter: determined (`value` set), bounded on one side, or not determined (`reason` says why).

    Attributes:
        value: best value, in the unit that the parameter's key names; None where it is not determined.
        standard_error: in the same unit, with the correlation of the noise allowed for.
        low_95: lower end of the 95 % interval; None where it is open.
        high_95: upper end of the 95 % interval; None where it is open.
        at_bound: whether the value lies at a limit of the search.
        reason: why there is no value, or only a bound.
        unit: the unit of all of these, as the key names it; empty of a pure number.

    ``float(estimate)`` is the value, NaN where it is not determined; arithmetic, functions of numpy and ``f"{estimate:.3g}"`` are those of the
    value, for parameters of one fit err together: `Fit.correlated_values` has them with their correlations.
    """

    value: float | None
    standard_error: float | None
    low_95: float | None
    high_95: float | None
    at_bound: bool = False
    reason: str | None = None
    unit: str = ""

    def __float__(self) -> float:
        return nan if self.value is None else self.value

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        import numpy

        return numpy.array(float(self), dtype=dtype)

    def __format__(self, wanted: str) -> str:
        return format(float(self), wanted) if wanted else str(self)

    def __add__(self, other: Any) -> Any:
        return float(self) + other

    def __radd__(self, other: Any) -> Any:
        return other + float(self)

    def __sub__(self, other: Any) -> Any:
        return float(self) - other

    def __rsub__(self, other: Any) -> Any:
        return other - float(self)

    def __mul__(self, other: Any) -> Any:
        return float(self) * other

    def __rmul__(self, other: Any) -> Any:
        return other * float(self)

    def __truediv__(self, other: Any) -> Any:
        return float(self) / other

    def __rtruediv__(self, other: Any) -> Any:
        return other / float(self)

    def __pow__(self, other: Any) -> Any:
        return float(self) ** other

    def __rpow__(self, other: Any) -> Any:
        return other ** float(self)

    def __neg__(self) -> float:
        return -float(self)

    def __abs__(self) -> float:
        return abs(float(self))

    def __str__(self) -> str:
        if self.value is None:
            bounds = [f"above {self.low_95:.4g}"] if self.low_95 is not None else []
            bounds += [f"below {self.high_95:.4g}"] if self.high_95 is not None else []
            known = " and ".join(bounds) or "not determined"
            return f"{known} ({self.reason})" if self.reason else known
        decimals = self._decimals()
        text = _shown(self.value, decimals)
        if self.standard_error is not None:
            text += f" +- {self.standard_error:.2g}"
        ends = tuple("open" if end is None else _shown(end, decimals) for end in (self.low_95, self.high_95))
        text += f"  (95 %: {ends[0]} .. {ends[1]})"
        if self.at_bound:
            text += "  at a limit of the search"
        return text

    def _cells(self) -> tuple[str, str, str, str]:
        """Value, standard error, interval and what is to be said, for a table."""
        if self.value is None:
            return "", "", "", str(self)
        decimals = self._decimals()
        ends = ["open" if end is None else _shown(end, decimals) for end in (self.low_95, self.high_95)]
        error = "" if self.standard_error is None else f"{self.standard_error:.2g}"
        return _shown(self.value, decimals), error, " .. ".join(ends), "at a limit of the search" if self.at_bound else ""

    def _decimals(self) -> int | None:
        """Decimals at which the standard error, or the narrower side of the interval, has two digits."""
        ends = [end for end in (self.low_95, self.high_95) if end is not None]
        sizes = [abs(float(self) - end) for end in ends] + [self.standard_error or 0.0]
        known = [size for size in sizes if 0.0 < size < inf]
        return 1 - floor(log10(min(known))) if known else None


def _shown(number: float, decimals: int | None) -> str:
    """A number with that many decimals, five digits where they are not known: rounded alike, an interval holds its value."""
    if decimals is None or number == 0.0 or not isfinite(number):
        return f"{number:.5g}"
    return f"{number:.{min(17, max(1, floor(log10(abs(number))) + 1 + decimals))}g}"
