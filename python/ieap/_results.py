"""Fits and findings as people read them. Everything here shows what the engine found; nothing is calculated."""

from __future__ import annotations

import json
from dataclasses import dataclass
from html import escape
from math import floor, inf, isfinite, log10
from typing import Any, Iterator, Mapping, Sequence

from . import _native
from ._errors import EngineFault, InputError


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
        sizes = [abs(self.value - end) for end in ends] + [self.standard_error or 0.0]
        known = [size for size in sizes if 0.0 < size < inf]
        return 1 - floor(log10(min(known))) if known else None


def _shown(number: float, decimals: int | None) -> str:
    """A number with that many decimals, five digits where they are not known: rounded alike, an interval holds its value."""
    if decimals is None or number == 0.0 or not isfinite(number):
        return f"{number:.5g}"
    return f"{number:.{min(17, max(1, floor(log10(abs(number))) + 1 + decimals))}g}"


def data_frame(columns: Mapping[str, list[Any]], library: str) -> Any:
    """Columns as a data frame of pandas or polars."""
    if library == "pandas":
        import pandas

        return pandas.DataFrame(columns)
    if library == "polars":
        import polars

        return polars.DataFrame(columns, strict=False)
    raise InputError(f"found {library!r}", "library", "pandas or polars", "bad-argument")


def html_table(head: str, names: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str]) -> str:
    """A table for notebooks; texts are escaped."""
    titles = "".join(f"<th>{escape(name)}</th>" for name in names)
    cells = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return (
        f"<div><p><b>{escape(head)}</b></p><table><thead><tr>{titles}</tr></thead>"
        f"<tbody>{cells}</tbody></table><ul>{said}</ul></div>"
    )


class Fit:
    """Parameters of one run under one model, with everything needed to judge them.

    ``fit["r1_ohm_cm2"]`` is an `Estimate`; the keys carry the units, and ``fit["r1"]`` is the same where one key only begins
    so. ``for key in fit`` goes over the keys, in the model's order, derived ones last.
    """

    __slots__ = ("_made", "_recipe", "_document", "_parameters")

    def __init__(self, native: _native.Fit, recipe: tuple[Any, ...]) -> None:
        self._made: _native.Fit | None = native
        self._recipe = recipe
        self._document: dict[str, Any] | None = None
        self._parameters: dict[str, Estimate] | None = None

    @property
    def _native(self) -> _native.Fit:
        # A fit that was pickled is made again where its curves are asked for: the same readings give the same bits.
        if self._made is None:
            made = _native.fit(*self._recipe)
            if json.loads(made.document())["input_hash"] != self.to_dict()["input_hash"]:
                raise EngineFault("another version of ieap makes another fit of it", self.run, "fit the readings again")
            self._made = made
        return self._made

    def __getstate__(self) -> dict[str, Any]:
        return {"recipe": self._recipe, "document": self.to_dict()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._made, self._recipe = None, state["recipe"]
        self._document, self._parameters = state["document"], None

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

    def _key(self, name: str) -> str | None:
        """The key of that name, or the only one that begins so."""
        if name in self.parameters:
            return name
        begun = [key for key in self.parameters if key.startswith(f"{name}_")]
        return begun[0] if len(begun) == 1 else None

    def __getitem__(self, key: str) -> Estimate:
        known = self._key(key)
        if known is None:
            raise KeyError(f"{key}: one of {', '.join(self.parameters)}")
        return self.parameters[known]

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and self._key(key) is not None

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self.parameters)

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
        """Every reading of the current that was fitted, an Arrow table of n rows: ``time_s``, ``current_a``, ``fitted`` (A)
        and ``residual_sigma`` (standard deviations of the noise). None where there is none. Of `distributed` a longer curve
        is thinned as it is drawn."""
        return self._native.curve("current")

    @property
    def curvature(self) -> _native.ArrowTable | None:
        """The curvature likewise: ``time_s``, ``curvature_per_cm``, ``fitted`` (1/cm), ``residual_sigma``."""
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
    def baseline_v(self) -> float:
        """Voltage held before the drive, V."""
        return self._native.drive[0]

    @property
    def seconds(self) -> float:
        """Time that the engine took, s."""
        return self._native.seconds

    @property
    def covariance(self) -> dict[str, dict[str, float]] | None:
        """Covariance of the parameters that are determined, by their keys, in the product of their units. Its diagonal are the
        fit's standard errors squared; the correlations are those that the readings leave, their noise taken as white. None of
        `distributed`, and of what bends alone."""
        found = self._native.covariance()
        return found and {key: dict(zip(found[0], row)) for key, row in zip(*found)}

    @property
    def correlation(self) -> dict[str, dict[str, float]] | None:
        """The same as correlations, from -1 to 1."""
        own = self.covariance
        return own and {
            key: {other: value / (own[key][key] * own[other][other]) ** 0.5 for other, value in row.items()}
            for key, row in own.items()
        }

    def eval(self, time_s: Any = None, drive: Any = None, **options: Any) -> _native.Table:
        """What the fitted model gives at `time_s` (s) under `drive`; as `ieap.simulate` of this fit, whose options it takes.
        None: the readings' own times and drive, which give the curve of the fit."""
        from . import simulate

        if time_s is None and drive is None:
            curve = self.current or self.curvature
            time_s = curve.column("time_s") if curve else None
        return simulate(self, time_s=time_s, drive=drive, **options)

    def summary(self) -> str:
        """The fit in lines for people: parameters, goodness, issues."""
        return repr(self)

    def rows(self) -> dict[str, list[Any]]:
        """The parameters as columns: ``parameter``, ``value``, ``standard_error``, ``low_95``, ``high_95``, ``at_bound``,
        ``reason``."""
        names = ("value", "standard_error", "low_95", "high_95", "at_bound", "reason")
        columns = {name: [getattr(own, name) for own in self.parameters.values()] for name in names}
        return {"parameter": list(self.parameters), **columns}

    def to_dataframe(self, library: str = "pandas") -> Any:
        """The parameters as a data frame, one row each; `library` is ``"pandas"`` or ``"polars"``."""
        return data_frame(self.rows(), library)

    def plot(self, axes: Any = None) -> Any:
        """Readings, fitted curve and residuals, one column a response; gives the matplotlib figure.

        Args:
            axes: two axes for each response (curve, residuals), in an array of two rows; None: a figure of its own.
        """
        from ._plot import plot_fit

        return plot_fit(self, axes)

    def _repr_html_(self) -> str:
        stated = self.to_dict()
        head = f"{stated['run']} with {stated['model']}: {stated['why_stopped']}"
        rows = [(key, *own._cells()) for key, own in self.parameters.items()]
        notes = [
            f"R2 of the {name}: {stated[f'r_squared_{name}']:.5f}"
            for name in ("current", "curvature")
            if stated[f"r_squared_{name}"] is not None
        ]
        notes += [f"{issue['severity']}: {issue['message']}" for issue in stated["issues"]]
        return html_table(head, ("parameter", "value", "standard error", "95 %", ""), rows, notes)

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
        """``right``, ``undecided``, ``differs``, ``law``, ``instrument``, ``unexplained`` or ``data-problem``."""
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
        """Ids of the textbook curves that lie within the band of the missing law."""
        return self._document["set"]

    @property
    def missing(self) -> list[dict[str, Any]]:
        """Laws that are missing: ``place``, ``law``, ``variable``, ``name``, ``curve`` with its band, ``held_out``."""
        return self._document["missing"]

    @property
    def account(self) -> dict[str, float] | None:
        """Of what the squared error of the base model is made, percent; None where it could not be asked."""
        return self._document["account"]

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

    def summary(self) -> str:
        """The finding in lines for people: verdict, what is probable, what to measure next."""
        return repr(self)

    def rows(self) -> dict[str, list[Any]]:
        """What may be behind the misfit as columns, the most probable first: ``cause``, ``probability``."""
        own = self.posterior
        return {
            "cause": [_cause(one) for one in own],
            "probability": [one["mass"] for one in own],
        }

    def to_dataframe(self, library: str = "pandas") -> Any:
        """What may be behind the misfit as a data frame; `library` is ``"pandas"`` or ``"polars"``."""
        return data_frame(self.rows(), library)

    def _repr_html_(self) -> str:
        head = f"{self._document['group']}, {len(self._document['runs'])} runs: {self.verdict}"
        rows = [(_cause(own), f"{own['mass']:.2f}") for own in self.posterior[:5]]
        notes = [self.sentence] + ([f"next: {self.next_run['drive']}"] if self.next_run else []) + list(self.remarks)
        return html_table(head, ("what may be behind it", "probability"), rows, notes)

    def __repr__(self) -> str:
        lines = [f"<ieap.Finding of {self._document['group']!r}, {len(self._document['runs'])} runs: {self.verdict}>"]
        lines.append(f"  {self.sentence}")
        for own in self.posterior[:3]:
            lines.append(f"  {own['mass']:.2f}  {_cause(own)}")
        if self.next_run:
            lines.append(f"  next: {self.next_run['drive']}")
        lines += [f"  {remark}" for remark in self.remarks]
        return "\n".join(lines)


def _cause(hypothesis: Mapping[str, Any]) -> str:
    """What a row of the posterior speaks of, in words."""
    return hypothesis["effect"] or ", ".join(hypothesis["parameters_that_differ"]) or hypothesis["kind"]
