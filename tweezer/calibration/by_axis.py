"""Results of several axes, accessible by index or by the name of the axis."""

from __future__ import annotations

from typing import Any, Protocol, SupportsIndex, TypeVar, get_args, overload

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema


class _OfAxis(Protocol):
    """Result that belongs to one axis."""

    @property
    def axis(self) -> str:
        """Name of the axis."""


T = TypeVar("T", bound=_OfAxis)


class ByAxis(tuple[T, ...]):
    """Results of several axes, accessible as `axes[0]` or `axes["x"]`."""

    __slots__ = ()

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema by which pydantic reads a list of results from a file."""
        entry = handler.generate_schema(get_args(source)[0])
        entries = core_schema.tuple_variable_schema(entry)
        return core_schema.no_info_after_validator_function(cls, entries)

    @overload
    def __getitem__(self, key: str | SupportsIndex) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[T, ...]: ...

    def __getitem__(self, key: Any) -> Any:
        """Return the result of an axis, by number or name; raise `KeyError` for an unknown name."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        for each in self:
            if each.axis == key:
                return each
        there = ", ".join(each.axis for each in self)
        raise KeyError(f"axes[{key!r}]: no such axis; choose from: {there or 'none'}")
