"""What goes wrong, as exceptions that keep place, reason and remedy apart."""

from __future__ import annotations


class IeapError(Exception):
    """The engine could not do what was asked.

    Attributes:
        reason: what was found, and what was needed.
        place: where: a file with line and column, a column, an argument; empty where the whole input is meant.
        remedy: how to mend it; empty where nothing mends it.
        code: a stable word for scripts, such as ``no-drive``; empty where there is none.
    """

    def __init__(self, reason: str, place: str = "", remedy: str = "", code: str = "") -> None:
        super().__init__(reason, place, remedy, code)
        self.reason = reason
        self.place = place
        self.remedy = remedy
        self.code = code

    def __reduce__(self) -> tuple[type, tuple[str, str, str, str]]:
        # OSError would keep two of the four.
        return type(self), (self.reason, self.place, self.remedy, self.code)

    def __str__(self) -> str:
        where = f"{self.place}: " if self.place else ""
        mend = f". To mend it: {self.remedy}" if self.remedy else ""
        return f"{where}{self.reason}{mend}"


class InputError(IeapError, ValueError):
    """A file, a table or an argument was refused."""


class CampaignError(IeapError, OSError):
    """The disk or the database of a campaign refused."""

    # OSError has a text of its own.
    __str__ = IeapError.__str__


class MissingFileError(CampaignError, FileNotFoundError):
    """There is no such file."""


class EngineFault(IeapError, RuntimeError):
    """A fault of the program. Please report it with the readings."""
