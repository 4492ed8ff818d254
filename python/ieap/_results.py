"""Fits and findings as people read them. Everything here shows what the engine found; nothing is calculated."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Mapping

from . import _native


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
    """

    value: float | None
    standard_error: float | None
    low_95: float | None
    high_95: float | None
    at_bound: bool
    reason: str | None

    def __str__(self) -> str:
        if self.value is None:
            ends = [f"above {self.low_95:.4g}"] if self.low_95 is not None else []
            ends += [f"below {self.high_95:.4g}"] if self.high_95 is not None else []
            known = " and ".join(ends) or "not determined"
            return f"{known} ({self.reason})" if self.reason else known
        text = f"{self.value:.5g}"
        if self.standard_error is not None:
            text += f" +- {self.standard_error:.2g}"
        ends = tuple("open" if end is None else f"{end:.4g}" for end in (self.low_95, self.high_95))
        text += f"  (95 %: {ends[0]} .. {ends[1]})"
        if self.at_bound:
            text += "  at a limit of the search"
        return text


class Fit:
    """Parameters of one run under one model, with everything needed to judge them.

    ``fit["r1_ohm_cm2"]`` is an `Estimate`; the keys carry the units.
    """

    __slots__ = ("_native", "_document", "_parameters")

    def __init__(self, native: _native.Fit) -> None:
        self._native = native
        self._document: dict[str, Any] | None = None
        self._parameters: dict[str, Estimate] | None = None

    def to_dict(self) -> dict[str, Any]:
        """The fit as ``ieap fit --json`` states it, less what only a campaign knows."""
        if self._document is None:
            self._document = json.loads(self._native.document())
        return self._document

    @property
    def parameters(self) -> Mapping[str, Estimate]:
        """Estimates by key, in the model's order, derived ones last."""
        if self._parameters is None:
            stated = self.to_dict()["parameters"]
            self._parameters = {key: Estimate(**own) for key, own in stated.items()}
        return self._parameters

    def __getitem__(self, key: str) -> Estimate:
        return self.parameters[key]

    @property
    def run(self) -> str:
        """Name of the run."""
        return self.to_dict()["run"]

    @property
    def model(self) -> str:
        """Id of the model, such as ``lumped-2``."""
        return self.to_dict()["model"]

    @property
    def converged(self) -> bool:
        """Whether the search converged."""
        return self.to_dict()["converged"]

    @property
    def why_stopped(self) -> str:
        """Why the search stopped, in words."""
        return self.to_dict()["why_stopped"]

    @property
    def n_samples(self) -> int:
        """Number of readings used, over all fitted channels."""
        return self.to_dict()["n_samples"]

    @property
    def r_squared_current(self) -> float | None:
        """Coefficient of determination of the current; None where it was not fitted."""
        return self.to_dict()["r_squared_current"]

    @property
    def r_squared_curvature(self) -> float | None:
        """Coefficient of determination of the curvature; None where it was not fitted."""
        return self.to_dict()["r_squared_curvature"]

    @property
    def noise(self) -> list[dict[str, Any]]:
        """Noise and residual of each channel, in the channel's unit."""
        return self.to_dict()["noise"]

    @property
    def issues(self) -> list[dict[str, Any]]:
        """What a reader must know: ``severity``, ``code``, ``place``, ``message``, ``mend``."""
        return self.to_dict()["issues"]

    @property
    def current(self) -> _native.ArrowTable | None:
        """The current as it is drawn (thinned), an Arrow table of n rows: ``time_s``, ``current_a``, ``fitted`` (A) and
        ``residual_sigma`` (standard deviations of the noise). None where there is none."""
        return self._native.curve("current")

    @property
    def curvature(self) -> _native.ArrowTable | None:
        """The curvature as it is drawn: ``time_s``, ``curvature_per_cm``, ``fitted`` (1/cm), ``residual_sigma``."""
        return self._native.curve("curvature")

    @property
    def area_cm2(self) -> float:
        """Active area of the strip, cm2."""
        return self._native.area_cm2

    @property
    def length_mm(self) -> float | None:
        """Free length of the strip, mm."""
        return self._native.length_mm

    @property
    def drive(self) -> list[tuple[float, float | None]]:
        """Start (s) and voltage (V; None: open circuit) of each segment of the drive."""
        return self._native.drive[1]

    @property
    def seconds(self) -> float:
        """Time that the engine took, s."""
        return self._native.seconds

    def __repr__(self) -> str:
        stated = self.to_dict()
        lines = [f"<ieap.Fit of {stated['run']!r} with {stated['model']}: {stated['why_stopped']}>"]
        width = max(len(key) for key in self.parameters)
        lines += [f"  {key:<{width}}  {own}" for key, own in self.parameters.items()]
        for name in ("current", "curvature"):
            if (r_squared := stated[f"r_squared_{name}"]) is not None:
                lines.append(f"  R2 of the {name}: {r_squared:.5f}")
        lines += [f"  {issue['severity']}: {issue['message']}" for issue in stated["issues"]]
        return "\n".join(lines)


class Finding:
    """What the model gets wrong in a group of runs, and why; see `ieap.diagnose`."""

    __slots__ = ("_document",)

    def __init__(self, document: dict[str, Any]) -> None:
        self._document = document

    def to_dict(self) -> dict[str, Any]:
        """The finding as a group of ``ieap diagnose --json``."""
        return self._document

    @property
    def verdict(self) -> str:
        """``consistent``, ``undecided``, ``named``, ``set``, ``partial``, ``varies``, ``resembles``, ``unknown`` or
        ``data-problem``."""
        return self._document["verdict"]

    @property
    def sentence(self) -> str:
        """The finding in one plain sentence."""
        return self._document["sentence"]

    @property
    def p_misfit(self) -> float | None:
        """Probability of residuals at least as bad by chance."""
        return self._document["p_misfit"]

    @property
    def causes(self) -> list[str]:
        """Ids of the effects that may be the cause: the smallest set with 95 % of the probability."""
        return self._document["set"]

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Accepted effects with their parameters (estimates as dictionaries) and p."""
        return self._document["effects"]

    @property
    def posterior(self) -> list[dict[str, Any]]:
        """What may be behind the misfit, the most probable first; ``mass`` is the probability."""
        return self._document["posterior"]

    @property
    def gain(self) -> dict[str, Any] | None:
        """How much better held-out readings are predicted by the extended model; None where there is none."""
        return self._document["gain"]

    @property
    def where(self) -> dict[str, Any] | None:
        """Where in time and voltage the base model is wrong."""
        return self._document["where"]

    @property
    def next_run(self) -> dict[str, Any] | None:
        """What to measure next, and which causes it would tell apart."""
        return self._document["next_run"]

    @property
    def remarks(self) -> list[str]:
        """What a reader must know of the readings."""
        return self._document["remarks"]

    def __repr__(self) -> str:
        lines = [f"<ieap.Finding of {self._document['group']!r}, {len(self._document['runs'])} runs: {self.verdict}>"]
        lines.append(f"  {self.sentence}")
        for own in self.posterior[:3]:
            name = own["effect"] or ", ".join(own["parameters_that_differ"]) or own["kind"]
            form = f" ({own['form']})" if own["form"] else ""
            lines.append(f"  {own['mass']:.2f}  {name}{form}")
        if self.next_run:
            lines.append(f"  next: {self.next_run['drive']}")
        lines += [f"  {remark}" for remark in self.remarks]
        return "\n".join(lines)
