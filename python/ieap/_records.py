"""Results as objects: names, meanings and units are those of the documents' schemas (`ieap list schemas`)."""

from __future__ import annotations

import json
from functools import lru_cache
from keyword import iskeyword
from types import new_class
from typing import Any, ClassVar

from . import _native
from ._estimate import Estimate


class Record:
    """A part of a result: its attributes are what ``--json`` of the program prints, and `help` says what each is, in which unit.

    Numbers with uncertainty are `Estimate`, parts are records, lists are lists; ``to_dict()`` is the document itself.
    """

    __slots__ = ("_stated",)
    _of: ClassVar[tuple[str, str]] = ("", "")

    def __init__(self, stated: dict[str, Any]) -> None:
        """Made by the package."""
        self._stated = stated

    def __init_subclass__(cls, of: tuple[str, str] | None = None) -> None:
        if of is None:
            return
        cls._of = of
        node = _node(*of)
        cls.__doc__ = cls.__doc__ or node.get("description")
        for name, about in node["properties"].items():
            if not hasattr(cls, name):
                # `from` and `with` are words of Python.
                setattr(cls, f"{name}_" if iskeyword(name) else name, _attribute(of[0], name, about))

    def to_dict(self) -> dict[str, Any]:
        """The same as plain dictionaries and lists."""
        return self._stated

    def __getattr__(self, name: str) -> Any:
        # What is there has a property; this is for what a type checker cannot see, and for what is misspelt.
        known = ", ".join(part for part in dir(type(self)) if not part.startswith("_"))
        raise AttributeError(f"{type(self).__name__} has no {name!r}: one of {known}")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._stated == other._stated

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return record, (*self._of, self._stated)

    def __str__(self) -> str:
        return str(self._stated.get("message") or self._stated.get("sentence") or repr(self))

    def __repr__(self) -> str:
        shown = (f"{name}={_short(value)}" for name, value in self._stated.items() if name != "schema")
        return f"{type(self).__name__}({', '.join(shown)})"


def _short(value: Any) -> str:
    if isinstance(value, dict):
        return "{...}"
    if isinstance(value, list) and len(value) > 3:
        return f"[... {len(value)}]"
    return repr(value)


_OWN: dict[tuple[str, str], type[Record]] = {}


def own(kind: type[Record]) -> type[Record]:
    """Registers a class that has more than the document's own attributes."""
    _OWN[kind._of] = kind
    return kind


def record(schema: str, definition: str, stated: dict[str, Any]) -> Any:
    """A part of a document, as an object; ``""`` is the document itself."""
    return _class(schema, definition)(stated)


@lru_cache(maxsize=None)
def _schema(name: str) -> Any:
    return json.loads(_native.schema(name))


def _node(schema: str, definition: str) -> Any:
    whole = _schema(schema)
    return whole["$defs"][definition] if definition else whole


@lru_cache(maxsize=None)
def _class(schema: str, definition: str) -> type[Record]:
    found = _OWN.get((schema, definition))
    if found is not None:
        return found
    name = definition.removesuffix("Entry").removesuffix("Document") or schema.title()
    return new_class(name, (Record,), {"of": (schema, definition)}, lambda parts: parts.update(__slots__=()))


def _attribute(schema: str, name: str, about: Any) -> property:
    def read(self: Record) -> Any:
        return _value(schema, about, self._stated.get(name), name)

    return property(read, doc=about.get("description"))


def _value(schema: str, node: Any, stated: Any, key: str) -> Any:
    """What a schema says of a value, as an object."""
    if isinstance(stated, list):
        items = node.get("items", {})
        return [_value(schema, items, part, key) for part in stated]
    if not isinstance(stated, dict):
        return stated
    for choice in (*node.get("anyOf", ()), *node.get("oneOf", ()), *node.get("allOf", ())):
        if choice.get("type") != "null":
            return _value(schema, choice, stated, key)
    definition = node.get("$ref", "").rsplit("/", 1)[-1]
    if definition == "Estimate":
        return Estimate(**stated, unit=_native.unit_of_key(key))
    if definition:
        inner = _node(schema, definition)
        return record(schema, definition, stated) if "properties" in inner else _value(schema, inner, stated, key)
    each = node.get("additionalProperties")
    return {name: _value(schema, each, part, name) for name, part in stated.items()} if isinstance(each, dict) else stated
