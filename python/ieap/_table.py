"""Tables: readings of a run, and results."""

from __future__ import annotations

import json
from array import array
from html import escape
from typing import TYPE_CHECKING, Any, Iterator, Sequence

from . import _native
from ._errors import InputError

if TYPE_CHECKING:
    import pandas
    import polars

_SHOWN_ROWS = 50


class Table:
    """Columns under names that carry their units: readings of a run, or results.

    ``table["current_a"]`` is a numpy array, on the table's own memory and read-only. An empty cell is NaN among numbers, None
    among words. The package needs nothing but Python: where numpy is not installed, numbers are an `array.array` and all else
    a list. (An object that only can be made into an array would be the same everywhere, and nobody's arithmetic.)

    pyarrow, polars and DuckDB take the table itself, as Arrow, without a copy; pandas by ``to_pandas()``, or by
    ``pandas.DataFrame.from_arrow``. Iterating goes over the names of the columns, as `dict(table)` does; ``len(table)`` is
    the number of rows.
    """

    __slots__ = ("_readings", "_arrow")

    def __init__(self, native: _native.Readings | _native.ArrowTable) -> None:
        """Made by the package."""
        self._readings = native if isinstance(native, _native.Readings) else None
        self._arrow = native if isinstance(native, _native.ArrowTable) else None

    @property
    def _columns(self) -> _native.ArrowTable:
        if self._arrow is None:
            assert self._readings is not None
            self._arrow = self._readings.columns()
        return self._arrow

    @property
    def num_rows(self) -> int:
        """Number of rows."""
        return self._columns.num_rows

    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        return self._columns.column_names

    @property
    def source(self) -> str:
        """The file, the run, or where else readings are from; empty of results."""
        return self._readings.source if self._readings is not None else ""

    def __getitem__(self, name: str) -> Any:
        numbers = self._columns.numbers(name)
        try:
            import numpy
        except ImportError:
            return self.column(name) if numbers is None else array(numbers.typecode, numbers.tobytes())
        if numbers is not None:
            return numpy.asarray(numbers)
        cells = self.column(name)
        if cells and all(isinstance(cell, bool) for cell in cells):
            return numpy.array(cells)
        objects: Any = numpy.empty(len(cells), dtype=object)
        for row, cell in enumerate(cells):
            objects[row] = cell
        return objects

    def column(self, name: str) -> list[Any]:
        """One column as a list; an empty cell is None."""
        return self._columns.column(name)

    def keys(self) -> list[str]:
        """Names of the columns, so that `dict(table)` has them all."""
        return self.column_names

    def __iter__(self) -> Iterator[str]:
        return iter(self.column_names)

    def __contains__(self, name: object) -> bool:
        return name in self.column_names

    def __len__(self) -> int:
        return self.num_rows

    def to_dict(self) -> dict[str, list[Any]]:
        """All columns by name, as lists; an empty cell is None."""
        return {name: self.column(name) for name in self}

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a data frame of pandas."""
        import pandas

        return pandas.DataFrame(dict(self))

    def to_polars(self) -> polars.DataFrame:
        """The table as a data frame of polars, without a copy."""
        import polars

        return polars.DataFrame(self)

    def describe(self) -> dict[str, Any]:
        """What is known of readings beside themselves: format, status, start, tags, columns with their raw names, issues. Of
        results the columns with their units."""
        if self._readings is not None:
            known: dict[str, Any] = json.loads(self._readings.describe())
            return known
        return {"columns": [{"name": name, "unit": _native.unit_of_key(name)} for name in self]}

    def __array__(self, *_: Any, **__: Any) -> Any:
        # One array has no names of columns; pandas, which asks for one, would lose them.
        remedy = "take table.to_pandas(), or a column: table[\"time_s\"]"
        raise InputError("a table is no one array: its columns have names and units", "table", remedy, "no-array")

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._columns.__arrow_c_stream__(requested_schema)

    def __arrow_c_schema__(self) -> object:
        return self._columns.__arrow_c_schema__()

    def __reduce__(self) -> tuple[Any, ...]:
        if self._readings is not None:
            return Table, (self._readings,)
        try:
            from pyarrow import table
        except ImportError:
            remedy = "install pyarrow, or keep what to_dict() gives"
            raise InputError("a table of results is pickled by pyarrow", "pickle", remedy, "no-pyarrow") from None
        return _again, (table(self),)

    def _repr_html_(self) -> str:
        shown = [self.column(name)[:_SHOWN_ROWS] for name in self]
        cells = [["" if cell is None else cell for cell in row] for row in zip(*shown)]
        more = [f"{len(self) - _SHOWN_ROWS} more"] if len(self) > _SHOWN_ROWS else []
        return html_table(f"{self.source or 'table'}: {len(self)} rows", self.column_names, cells, more)

    def __repr__(self) -> str:
        if self._readings is not None:
            return repr(self._readings)
        return f"<ieap.Table: {len(self)} rows of {', '.join(self)}>"


def _again(table: Any) -> Table:
    return Table(_native.arrow_again(table))


def html_table(head: str, names: Sequence[str], rows: Sequence[Sequence[Any]], notes: Sequence[str]) -> str:
    """A table for notebooks; texts are escaped."""
    titles = "".join(f"<th>{escape(name)}</th>" for name in names)
    cells = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return (
        f"<div><p><b>{escape(head)}</b></p><table><thead><tr>{titles}</tr></thead>"
        f"<tbody>{cells}</tbody></table><ul>{said}</ul></div>"
    )
