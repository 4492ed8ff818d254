"""What the package's functions take, by the annotations that they state: a refusal names the argument and what it takes."""

from __future__ import annotations

import re
from functools import wraps
from inspect import signature
from operator import index
from os import PathLike
from typing import Any, Callable, TypeVar, cast

from . import _native
from ._errors import InputError

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _is_number(value: Any) -> bool:
    return hasattr(value, "__float__") and not isinstance(value, (bool, str, bytes))


def _is_whole(value: Any) -> bool:
    try:
        return not isinstance(value, bool) and 0 <= index(value) < 2**64
    except TypeError:
        return False


_KINDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "float": (_is_number, "a number"),
    "int": (_is_whole, "a whole number from 0 to 2^64 - 1"),
    "bool": (lambda value: isinstance(value, bool) or type(value).__name__ == "bool_", "True or False"),
    "str": (lambda value: isinstance(value, str), "a text"),
    "PathLike": (lambda value: isinstance(value, PathLike), "a path"),
    "Mapping": (lambda value: hasattr(value, "items"), "a mapping"),
    "Sequence": (lambda value: hasattr(value, "__iter__") and not isinstance(value, (str, bytes)), "a list"),
    "None": (lambda value: value is None, "None"),
}
"""What an annotation may say, how it is told, and what it is called. What says something else is left to the function."""


def _of(annotation: object) -> list[tuple[Callable[[Any], bool], str]]:
    said, inner = str(annotation), 1
    while inner:
        said, inner = re.subn(r"\[[^\[\]]*\]", "", said)
    names = [name.strip() for name in said.split("|")]
    return [_KINDS[name] for name in names] if all(name in _KINDS for name in names) else []


def checked(function: _Function) -> _Function:
    """The function, which refuses arguments that are not of the kind that its annotations state, as an `InputError`."""
    stated = signature(function)
    kinds = {name: _of(parameter.annotation) for name, parameter in stated.parameters.items()}

    @wraps(function)
    def asked(*given: Any, **named: Any) -> Any:
        for name, value in stated.bind(*given, **named).arguments.items():
            allowed = kinds[name]
            if allowed and not any(is_one(value) for is_one, _ in allowed):
                unit = _native.unit_of_key(name)
                words = " or ".join(word for _, word in allowed if word != "None")
                alone = ": its error is not used here" if isinstance(value, tuple) else ""
                needed = f"give {words}{f', in {unit}' if unit else ''}{alone}"
                raise InputError(f"found {value!r}", name, needed, "bad-argument")
        return function(*given, **named)

    return cast(_Function, asked)
