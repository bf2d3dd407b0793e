"""Zarr stores of results, opened only if they are complete and have the form that tweezer writes.

Zarr would replace a missing chunk by its fill value, and would run decoders that the store names.
The description of a store is therefore checked before Zarr reads it.
"""

from __future__ import annotations

import itertools
import json
import math
import os
import warnings
from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import xarray as xr
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from xarray.core import indexing

from tweezer.values.errors import ResultError
from tweezer.values.files import digest, read_text, remove_left_over, write_whole

#: Name of the description of a group or an array
_ABOUT = "zarr.json"
#: File with the checksums of a store's chunks, and a digest of these and of the description
_SEAL = ".sha256"
#: Sizes of numbers, bytes
_SIZES = {"bool": 1, "int8": 1, "int16": 2, "int32": 4, "int64": 8, "float32": 4, "float64": 8}
#: Largest uncompressed sizes, bytes, of all arrays together, and of a chunk of texts
_MOST, _MOST_TEXTS = 2**31, 2**26
#: Largest size of the times of loss of an ensemble, bytes
_MOST_LOST = 2**28
#: Size of the checksum at the end of a chunk, bytes
_CHECKSUM = 4
#: First bytes of a Zstandard frame (RFC 8878, 3.1.1), and the number of bytes to read from it
_ZSTD, _HEAD = b"\x28\xb5\x2f\xfd", 18

Size = Annotated[int, Field(ge=0, strict=True)]


class _Part(BaseModel):
    """Base of parts of an array's description (zarr.json): immutable, without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class _Configuration(_Part):
    """Shape of the chunks of an array, in numbers along each dimension."""

    chunk_shape: tuple[Annotated[int, Field(ge=1, strict=True)], ...]


class _Grid(_Part):
    """Grid of chunks: regular, with chunks of one shape."""

    name: Literal["regular"]
    configuration: _Configuration


class _Separator(_Part):
    """Separator in the names of chunks, as in c/0/1."""

    separator: Literal["/"]


class _Keys(_Part):
    """Encoding of the indices of a chunk in its name."""

    name: Literal["default"]
    configuration: _Separator


class _Codec(_Part):
    """A step in encoding chunks: numbers to bytes, compression, or a checksum."""

    name: Literal["bytes", "vlen-utf8", "zstd", "crc32c"]
    configuration: dict[str, Any] = {}


class _Length(_Part):
    """Size of a text of fixed length, bytes."""

    length_bytes: Annotated[int, Field(ge=0, strict=True)]


class _Text(_Part):
    """Data type of texts of fixed length."""

    name: Literal["fixed_length_utf32"]
    configuration: _Length


class _Array(_Part):
    """Description of an array in the form that tweezer and xarray write."""

    zarr_format: Literal[3]
    node_type: Literal["array"]
    shape: tuple[Size, ...]
    data_type: (
        Literal["bool", "int8", "int16", "int32", "int64", "float32", "float64", "string"] | _Text
    )
    chunk_grid: _Grid
    chunk_key_encoding: _Keys
    fill_value: Any
    codecs: tuple[_Codec, ...]
    attributes: dict[str, Any] = {}
    dimension_names: tuple[str, ...]
    storage_transformers: tuple[()] = ()

    @property
    def compressed(self) -> bool:
        """Whether the chunks are compressed."""
        return "zstd" in self._decoders

    @property
    def _decoders(self) -> list[str]:
        """Names of the steps in encoding the chunks, in order."""
        return [each.name for each in self.codecs]

    @property
    def texts(self) -> bool:
        """Whether the array contains texts of variable length."""
        return self.data_type == "string"

    @property
    def item(self) -> int:
        """Size of one number or text, bytes; 1 for texts of variable length."""
        if isinstance(self.data_type, _Text):
            return self.data_type.configuration.length_bytes
        return _SIZES.get(self.data_type, 1)

    @property
    def size(self) -> int:
        """Size of the uncompressed array, bytes."""
        return self.item * math.prod(self.shape)

    @property
    def chunks(self) -> tuple[int, ...]:
        """Shape of a chunk, in numbers along each dimension."""
        return self.chunk_grid.configuration.chunk_shape

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each dimension."""
        return tuple(-(-size // each) for size, each in zip(self.shape, self.chunks, strict=True))

    def wrong(self) -> str:
        """Return the error in this description; "" without an error."""
        first = "vlen-utf8" if self.texts else "bytes"
        known = ([first], [first, "zstd"], [first, "crc32c"], [first, "zstd", "crc32c"])
        if self._decoders not in known:
            return f"is encoded by {', '.join(self._decoders)}"
        if not len(self.shape) == len(self.chunks) == len(self.dimension_names):
            return "has inconsistent numbers of dimensions in its shape, chunks and dimension names"
        if any(each > max(size, 1) for size, each in zip(self.shape, self.chunks, strict=True)):
            return "has chunks that are larger than the array"
        return ""


class _Described(NamedTuple):
    """Description of a store: attributes, arrays and files, before numbers are read."""

    attributes: dict[str, Any]
    """attributes of the result by name"""
    arrays: dict[str, _Array]
    """descriptions of the arrays by name"""
    files: set[str]
    """names of all files in the store, relative to it"""
    sums: dict[str, str]
    """checksums of chunks by name; for an ensemble only once it is complete"""


def open_store(path: Path) -> xr.Dataset:
    """Return the result in a Zarr store, whose arrays are read on demand.

    Raises `ResultError` for a folder that is not a store of tweezer, is damaged, lacks files, or
    contains links, and later for an array that cannot be read. An ensemble may lack whole blocks
    that were not computed, if their chunks of `lost_time` are missing too.
    """
    _check_whole(path, _described(path))
    return open_written(path)


def open_written(path: Path) -> xr.Dataset:
    """Return the result in a store that this program has written, without checking it.

    The existence of chunks is not checked, because a file system may show the chunks of other
    machines with a delay.
    """
    try:
        with warnings.catch_warnings(action="ignore"):  # texts are not yet in Zarr's specification
            store = xr.open_zarr(
                path, chunks=None, zarr_format=3, consolidated=True, decode_times=False
            )
            for each in store.coords.values():
                each.load()
            lazy = {}
            for name, each in store.items():
                read = indexing.LazilyIndexedArray(_Guarded(path, each.variable))
                lazy[name] = xr.Variable(each.dims, read, each.attrs, each.encoding)
            return store.assign(lazy)
    except ResultError:
        raise
    except Exception as error:  # Zarr raises errors of any type for a damaged store
        raise _unreadable(path, error) from None


def description_of_store(path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the attributes of a store and the checksums of its chunks, some of which may be
    missing.
    """
    found = _described(path)
    return found.attributes, found.sums


def names_in_store(path: Path) -> set[str]:
    """Return the names of the attributes, arrays and dimensions of a store."""
    about = json.loads(read_text(path / _ABOUT))
    arrays = about["consolidated_metadata"]["metadata"]
    dimensions = (name for each in arrays.values() for name in each["dimension_names"])
    return {*about["attributes"], *arrays, *dimensions}


def seal(path: Path, sums: Mapping[str, str] | None = None) -> None:
    """Write a digest of the description of a store into it, by which damage is detected.

    `sums` has checksums of its chunks by name. They reveal an intact chunk that belongs to another
    position or store. Raises `OSError` if the file cannot be written.
    """
    listed = "".join(f"{found} {name}\n" for name, found in sorted((sums or {}).items()))
    content = f"{digest(json.loads(read_text(path / _ABOUT)), listed)}\n{listed}"
    remove_left_over(path)
    write_whole(path / _SEAL, BytesIO(content.encode()))


def checksum(chunk: Path) -> str:
    """Return the checksum at the end of a chunk's file, which a reader compares with its content.

    Raises `OSError` if the file cannot be read.
    """
    with chunk.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _CHECKSUM))
        return file.read().hex()


def checksums(path: Path) -> dict[str, str]:
    """Return the checksums of all chunks of a store by name; raises `OSError`."""
    chunks = (name for name in _files(path) if name.split("/")[1:2] == ["c"])
    return {name: checksum(path / name) for name in chunks}


def _sealed(path: Path, about: object) -> dict[str, str]:
    """Return the checksums that `seal` wrote; stores of earlier versions have none."""
    sealed, _, listed = read_text(path / _SEAL).partition("\n")
    if sealed != digest(about, listed):
        raise ResultError(
            f"{path}: damaged: its {_ABOUT} differs from what was saved; if you changed it, delete "
            f"{path / _SEAL}"
        )
    lines = (line.partition(" ") for line in listed.splitlines())
    return {name: found for found, _, name in lines}


def _unreadable(path: Path, error: Exception) -> ResultError:
    """Return the error for a store that Zarr cannot read."""
    return ResultError(f"{path}: damaged, or not a result: {' '.join(str(error).split())[:500]}")


def _described(path: Path) -> _Described:
    """Read and check the description of a store."""
    try:
        if not path.is_dir():
            reason = "no such folder" if not path.exists() else "is no folder"
            raise ResultError(f"{path}: {reason}")
        if not (path / _ABOUT).exists():
            reason = "is in Zarr format 2; " if (path / ".zgroup").exists() else ""
            raise ResultError(f"{path}: not a result of tweezer: {reason}must have {_ABOUT}")
        files = _files(path)
        about = json.loads(read_text(path / _ABOUT))
        if not (about["zarr_format"] == 3 and about["node_type"] == "group"):
            raise ResultError(f"{path}: not a result of tweezer: is not a group in Zarr format 3")
        sums = _sealed(path, about) if _SEAL in files else {}
        attributes, listed = about["attributes"], about["consolidated_metadata"]["metadata"]
        arrays = {}
        for name, described in listed.items():
            if f"{name}/{_ABOUT}" not in files:
                raise ResultError(f"{path}: lacks {name}/{_ABOUT}: cut short or damaged")
            if json.loads(read_text(path / name / _ABOUT)) != described:
                raise ResultError(f"{path}: damaged: {name}/{_ABOUT} differs from what was saved")
            arrays[name] = _Array.model_validate(described)
            if reason := arrays[name].wrong():
                raise ResultError(f"{path}: not a result of tweezer: {name} {reason}")
        if not isinstance(attributes, dict):
            raise ResultError(f"{path}: not a result of tweezer: has no attributes")
    except ResultError:
        raise
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise ResultError(
            f"{path}: not a result of tweezer: {name}: {where}: {first['msg']}"
        ) from None
    except (OSError, ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise _unreadable(path, error) from None
    return _Described(attributes, arrays, files, sums)


def _files(path: Path) -> set[str]:
    """Return the names of all files in a store; raises `ResultError` if one is a link."""
    found = set()
    waiting = [""]
    for folder in waiting:
        with os.scandir(path / folder) as entries:
            for each in entries:
                name = f"{folder}{each.name}"
                if each.is_symlink():
                    raise ResultError(f"{path}: {name} is a link; must be a file in the store")
                if each.is_dir():
                    waiting.append(f"{name}/")
                elif each.is_file():
                    found.add(name)
                else:
                    raise ResultError(f"{path}: {name} is a pipe or a device; must be a file")
    return found


def _check_whole(path: Path, found: _Described) -> None:
    """Raise `ResultError` unless all chunks of a store exist and decompress to the declared sizes.

    An ensemble may lack blocks of trajectories that were not computed, as its chunks of `lost_time`
    show. `found` is the description of the store.
    """
    total = sum(each.size for each in found.arrays.values() if each.compressed)
    if total > _MOST:
        raise ResultError(f"{path}: its arrays have {total:,} bytes; must be at most {_MOST:,}")
    lost = found.arrays.get("lost_time")
    for name, array in found.arrays.items():
        blocks: list[int] | None = None
        if lost is not None and array.dimension_names[:1] == ("trajectory",):
            if array.fill_value != "NaN" or array.counts[0] != lost.counts[0]:
                raise ResultError(
                    f"{path}: not a result of tweezer: {name} and lost_time have different numbers "
                    "of blocks of trajectories"
                )
            if lost.size > _MOST_LOST:
                raise ResultError(
                    f"{path}: lost_time has {lost.size:,} bytes; must be at most {_MOST_LOST:,}"
                )
            ended = (each.removeprefix("lost_time/c/") for each in found.files)
            numbers = {int(each) for each in ended if each.isdecimal() and len(each) < 10}
            blocks = sorted(i for i in numbers if i < lost.counts[0])
        counts = array.counts if blocks is None else (len(blocks), *array.counts[1:])
        if not math.prod(counts):
            continue
        if math.prod(counts) > len(found.files):
            raise ResultError(f"{path}: {name} lacks chunks: cut short or damaged")
        for at in _indices(array, blocks):
            chunk = f"{name}/{'/'.join(['c', *map(str, at)])}"
            if chunk not in found.files:
                raise ResultError(f"{path}: lacks {chunk}: cut short or damaged")
            _check_chunk(path, chunk, array)
            if chunk in found.sums and checksum(path / chunk) != found.sums[chunk]:
                raise ResultError(
                    f"{path}: damaged: {chunk} differs from the chunk that was saved; if you "
                    f"changed it, delete {path / _SEAL}"
                )


def _indices(array: _Array, blocks: list[int] | None) -> Iterator[tuple[int, ...]]:
    """Yield the indices of the chunks that an array must have.

    `blocks` contains indices along the first dimension, or None for all.
    """
    ranges: list[Any] = [range(count) for count in array.counts]
    if blocks is not None:
        ranges[0] = blocks
    return itertools.product(*ranges)


def _check_chunk(path: Path, name: str, array: _Array) -> None:
    """Raise `ResultError` unless the file of a chunk has, or decompresses to, the correct size."""
    file = path / name
    size = array.item * math.prod(array.chunks)
    if array.compressed:
        with file.open("rb") as opened:
            unpacked = _unpacked(opened.read(_HEAD))
        sound = unpacked is not None and (
            unpacked <= _MOST_TEXTS if array.texts else unpacked == size
        )
    elif array.texts:
        sound = file.stat().st_size <= _MOST_TEXTS
    else:
        checked = array.codecs[-1].name == "crc32c"
        sound = file.stat().st_size == size + _CHECKSUM * checked
    if not sound:
        raise ResultError(f"{path}: {name} is cut short or damaged")


def _unpacked(head: bytes) -> int | None:
    """Return the size that a Zstandard frame declares, bytes; None if it declares none.

    `head` contains the first bytes of the frame (RFC 8878, 3.1.1). Its descriptor determines the
    length of the size field. A field of two bytes contains the size minus 256.
    """
    if len(head) < 6 or not head.startswith(_ZSTD):
        return None
    flags = head[4]
    single = bool(flags & 0x20)
    length = {0: int(single), 1: 2, 2: 4, 3: 8}[flags >> 6]
    begin = 5 + (not single) + (0, 1, 2, 4)[flags & 3]
    if not length or len(head) < begin + length:
        return None
    return int.from_bytes(head[begin : begin + length], "little") + 256 * (length == 2)


class _Guarded(xr.backends.BackendArray):
    """Values of a variable in a store, read on demand; raises `ResultError` if that fails."""

    def __init__(self, path: Path, variable: xr.Variable) -> None:
        self.path, self.variable = path, variable
        self.shape, self.dtype = variable.shape, variable.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        """Return the values at an index, in the way that xarray requires."""
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER, self._read
        )

    def _read(self, key: Any) -> Any:
        """Return the numbers at an index of xarray."""
        try:
            return self.variable[key].values
        except Exception as error:  # Zarr raises errors of any type for a damaged chunk
            raise _unreadable(self.path, error) from None
