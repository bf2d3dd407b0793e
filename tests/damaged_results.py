"""Saved results that are damaged, edited or hostile, for `tests.stress_faults`.

Each is read as it was saved, read with what was edited, or refused in one line that names the file.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import json
import os
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

import tweezer
from tests.mutations import counted, pick
from tweezer.results.io import load_result, write_result

SCENE = tweezer.load_scene("silica-1um").replace(
    simulation={"duration": 1e-5, "samples": 11, "model": "overdamped"}, medium={"inertia": "none"}
)
THERMAL = SCENE.replace(forces={"brownian": True})
#: Replacements of an attribute, or of a value in JSON
VALUES: tuple[Any, ...] = (
    "", "x", "{", "[]", "{}", "null", "[1, 2]", '{"a": 1}', "[" * 3000, "NaN", "y" * 5000, 0, 1,
    -1, 10**12, 1.5, -1e300, 1e-300, float("nan"), float("inf"), True,
)  # fmt: skip
#: Replacements of a number in an array
NUMBERS = (np.nan, np.inf, -np.inf, 1e300, -1e300, 1e39, 0.0, 1e-320)
#: Content of a file of the user's, which nothing may show
PRIVATE = 1.234567e-7


@functools.cache
def sound() -> Path:
    """Return a folder with a result of each kind."""
    folder = Path(tempfile.mkdtemp(prefix="tweezer-results-"))
    tweezer.save_run(tweezer.simulate(SCENE), folder / "run.nc")
    tweezer.save_run(tweezer.simulate(THERMAL, seed=1), folder / "thermal.nc")
    for name in ("ensemble.zarr", "statistics.nc"):
        tweezer.ensemble(THERMAL, 70, out=folder / name, statistics=name[0] == "s")
    tweezer.sweep(SCENE, {"bead.diameter": [0.5e-6, 1e-6]}, out=folder / "sweep.zarr", workers=1)
    trap = tweezer.characterise(SCENE)
    tweezer.save(trap, folder / "trap.json")
    rng = np.random.default_rng(1)
    recording = tweezer.Recording(
        np.arange(2000) * 1e-4, rng.normal(size=(2000, 2)) * 1e-8, ("x", "y"), name="drawn"
    )
    found = tweezer.calibrate(recording, temperature="293 K", radius="0.5 um", viscosity="1 mPa s")
    write_result(dataclasses.asdict(found), folder / "calibration.json")
    return folder


RESULTS = (
    "run.nc", "thermal.nc", "statistics.nc", "ensemble.zarr", "sweep.zarr", "trap.json",
    "calibration.json",
)  # fmt: skip


def copied(name: str) -> Path:
    """Return a copy of a sound result in the current folder."""
    path = Path(name)
    if path.suffix == ".zarr":
        shutil.copytree(sound() / name, path)
    else:
        shutil.copy(sound() / name, path)
    return path


# --- what is done to a result ---------------------------------------------------------------------


def damaged(rng: np.random.Generator, path: Path) -> str:
    """Change the bytes of a file of a result, as a failing disk or a copy cut short do."""
    files = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    file = files[rng.integers(len(files))]
    kind = str(pick(rng, ("changed", "cut", "empty", "missing", "a folder", "another's")))
    content = file.read_bytes()
    if kind == "changed":
        at = int(rng.integers(len(content))) if content else 0
        flipped = bytes([content[at] ^ 1 << int(rng.integers(8))]) if content else b"x"
        file.write_bytes(content[:at] + flipped + content[at + 1 :])
    elif kind == "cut":
        file.write_bytes(content[: rng.integers(max(1, len(content)))])
    elif kind == "empty":
        file.write_bytes(b"")
    elif kind == "another's":
        others = [each for each in files if each.read_bytes() != content]
        alike = [each for each in others if each.stat().st_size == len(content)]
        others = alike if alike and rng.random() < 0.5 else others
        file.write_bytes(others[rng.integers(len(others))].read_bytes() if others else b"{}")
    else:
        file.unlink()
        if kind == "a folder":
            file.mkdir()
        elif path.is_dir() and rng.random() < 0.5 and file.parent != path:
            shutil.rmtree(file.parent)
    return kind


def edited(rng: np.random.Generator, path: Path) -> str:
    """Change an attribute or a variable, as another program might."""
    if path.suffix == ".json":
        return _edited_json(rng, path)
    if path.suffix == ".zarr":
        return _edited_store(rng, path)
    with h5py.File(path, "r+") as file:
        return str(pick(rng, (_changed_attribute, _changed_variable))(rng, file))


def _edited_json(rng: np.random.Generator, path: Path) -> str:
    whole = json.loads(path.read_text())
    sealed = bool(rng.random() < 0.3)
    if not sealed:
        del whole["sha256"]
    _change_leaf(rng, whole)
    path.write_text(json.dumps(whole))
    return f"JSON {'with' if sealed else 'without'} its digest"


def _change_leaf(rng: np.random.Generator, within: Any) -> None:
    """Change, remove or add something, at any depth."""
    while True:
        keys = list(within) if isinstance(within, dict) else list(range(len(within)))
        if not keys:
            return
        key = keys[rng.integers(len(keys))]
        if isinstance(within[key], dict | list) and within[key] and rng.random() < 0.8:
            within = within[key]
            continue
        kind = rng.integers(4)
        if kind == 0:
            del within[key]
        elif kind == 1 and isinstance(within, dict):
            within[f"{key}x"] = within.pop(key)
        else:
            within[key] = pick(rng, (*VALUES, None, [], {}, [[1.0]], [None] * 3))
        return


def _edited_store(rng: np.random.Generator, path: Path) -> str:
    """Change the description of a store, in all places alike, or numbers of an array."""
    (path / ".sha256").unlink()
    if rng.random() < 0.4:
        import zarr

        group = zarr.open_group(path, mode="r+")
        names = [name for name, each in group.arrays() if each.dtype.kind == "f"]
        array = group[str(pick(rng, names))]
        values = array[...]
        values[rng.random(values.shape) < rng.choice([0.1, 1.0])] = pick(rng, NUMBERS)
        array[...] = values
        return "numbers of a store"
    about = json.loads((path / "zarr.json").read_text())
    if rng.random() < 0.5:
        _change_leaf(rng, about["attributes"])
        (path / "zarr.json").write_text(json.dumps(about))
        return "attributes of a store"
    arrays = about["consolidated_metadata"]["metadata"]
    name = str(pick(rng, list(arrays)))
    _change_leaf(rng, arrays[name])
    (path / "zarr.json").write_text(json.dumps(about))
    if rng.random() < 0.9:
        (path / name / "zarr.json").write_text(json.dumps(arrays[name]))
    return "description of an array"


def _changed_attribute(rng: np.random.Generator, file: h5py.File) -> str:
    of = file
    if rng.random() < 0.3:
        of = file[str(pick(rng, list(file)))]
    names = [name for name in of.attrs if not name.isupper() and not name.startswith("_")]
    if not names:
        return "nothing"
    name = str(pick(rng, names))
    del of.attrs[name]
    kind = rng.integers(8)
    if kind > 1:
        of.attrs[name] = pick(rng, VALUES)
    elif kind == 1:
        of.attrs[name] = np.zeros(int(rng.integers(4)))
    return "attribute"


def _changed_variable(rng: np.random.Generator, file: h5py.File) -> str:
    name = str(pick(rng, list(file)))
    dataset = file[name]
    shape, kind = dataset.shape, rng.integers(7)
    if kind == 0 or not dataset.size or dataset.dtype.kind != "f":
        del file[name]
        if rng.random() < 0.5:
            file[name] = pick(rng, (7, "text", np.zeros((2, 2)), np.zeros(0), [b"a", b"b"]))
        return "variable removed or replaced"
    if kind == 1:
        names = ("scale_factor", "add_offset", "dtype", "units", "_FillValue", "valid_range")
        dataset.attrs[str(pick(rng, names))] = pick(rng, VALUES)
        return "variable decoded otherwise"
    values = dataset[...]
    if kind == 2 and shape:
        values = values[::-1]
    elif kind == 3 and shape:
        values = np.sort(values, axis=0)[:: int(rng.choice([1, -1]))]
    else:
        values[rng.random(shape) < rng.choice([0.1, 1.0])] = pick(rng, NUMBERS)
    dataset[...] = values
    return "numbers"


def hostile(rng: np.random.Generator, path: Path) -> str:
    """Let a result name other files, decoders, or more numbers than there are."""
    if path.suffix == ".zarr":
        return _hostile_store(rng, path)
    if path.suffix == ".json":
        path.write_text("[" * 10**6 if rng.random() < 0.5 else '{"scene": ' * 10**5)
        return "JSON too deep"
    with h5py.File("private.h5", "w") as private:
        for name in ("x", "time"):
            private[name] = np.full((11, 3) if name == "x" else 11, PRIVATE)
    Path("private.bin").write_bytes(np.full(33, PRIVATE).tobytes())
    with h5py.File(path, "r+") as file:
        name = str(pick(rng, [each for each in file if file[each].dtype.kind == "f"]))
        shape = file[name].shape
        kind = str(pick(rng, ("external link", "external data", "virtual", "soft link out",
                              "declared", "extra", "bomb", "hole", "dimension")))  # fmt: skip
        if kind not in ("extra", "dimension"):
            del file[name]
        if kind == "external link":
            file[name] = h5py.ExternalLink("private.h5", "/x")
        elif kind == "external data":
            size = max(1, int(np.prod(shape))) * 8
            file.create_dataset(name, shape, "f8", external=[("private.bin", 0, size)])
        elif kind == "virtual":
            layout = h5py.VirtualLayout(shape=(11, 3), dtype="f8")
            layout[:] = h5py.VirtualSource("private.h5", "x", shape=(11, 3))
            file.create_virtual_dataset(name, layout)
        elif kind == "soft link out":
            file["elsewhere"] = h5py.ExternalLink("private.h5", "/")
            file[name] = h5py.SoftLink("/elsewhere/x")
        elif kind == "declared":
            file.create_dataset(name, (10**10,), "f8", chunks=(10**6,))
        elif kind == "extra":
            file.create_dataset("extra", (10**10,), "f8", chunks=(10**6,))
        elif kind == "bomb":
            zeros = file.create_dataset(name, (10**8,), "f8", chunks=(10**7,), compression=9)
            zeros.id.write_direct_chunk((0,), _packed_zeros())
            for first in range(10**7, 10**8, 10**7):
                zeros.id.write_direct_chunk((first,), _packed_zeros())
        elif kind == "hole":
            chunks = tuple(max(1, each // 2) for each in shape) or None
            made = file.create_dataset(name, shape or (4,), "f8", chunks=chunks or (2,))
            made[0] = 1.0
        else:
            file.create_dataset("long", (10**11,), "f8", chunks=(10**6,)).make_scale("long")
    return kind


@functools.cache
def _packed_zeros() -> bytes:
    import zlib

    return zlib.compress(bytes(8 * 10**7), 9)


def _hostile_store(rng: np.random.Generator, path: Path) -> str:
    Path("private").mkdir()
    chunks = sorted(each for each in path.glob("*/c/**/*") if each.is_file())
    chunk = chunks[rng.integers(len(chunks))]
    private = Path("private") / "secret"
    private.write_bytes(np.full(max(1, chunk.stat().st_size // 8), PRIVATE).tobytes())
    kind = str(pick(rng, ("link", "folder that is a link", "pickle", "codec", "declared", "chunks",
                          "format 2", "pipe")))  # fmt: skip
    if kind == "link":
        chunk.unlink()
        chunk.symlink_to(private.absolute())
    elif kind == "pipe":
        chunk.unlink()
        os.mkfifo(chunk)
    elif kind == "folder that is a link":
        shutil.move(chunk.parent, Path("private") / "c")
        chunk.parent.symlink_to((Path("private") / "c").absolute())
    elif kind in ("pickle", "format 2"):
        _write_pickle(path, whole=kind == "format 2")
    else:
        (path / ".sha256").unlink()
        about = json.loads((path / "zarr.json").read_text())
        arrays = about["consolidated_metadata"]["metadata"]
        name = chunk.relative_to(path).parts[0]
        if kind == "codec":
            arrays[name]["codecs"].append(
                {"name": str(pick(rng, ("numcodecs.zlib", "blosc", "gzip", "numcodecs.pickle"))),
                 "configuration": {}}
            )  # fmt: skip
        else:
            sizes = arrays[name]["shape"]
            sizes[int(rng.integers(len(sizes)))] = 10**11
            if kind == "chunks":
                arrays[name]["chunk_grid"]["configuration"]["chunk_shape"] = sizes
        (path / "zarr.json").write_text(json.dumps(about))
        (path / name / "zarr.json").write_text(json.dumps(arrays[name]))
    return kind


def _write_pickle(path: Path, *, whole: bool) -> None:
    """An array of Zarr's second format that runs code where it is read."""
    import pickle

    class Code:
        def __reduce__(self) -> Any:
            return os.mkdir, ("code-ran",)

    if whole:
        shutil.rmtree(path)
        path.mkdir()
        (path / ".zgroup").write_text('{"zarr_format": 2}')
    for name in ("time", "position", "outcome"):
        shutil.rmtree(path / name, ignore_errors=True)
        (path / name).mkdir()
        about = {
            "zarr_format": 2, "shape": [1], "chunks": [1], "dtype": "|O", "order": "C",
            "fill_value": None, "compressor": None,
            "filters": [{"id": "vlen-utf8"}, {"id": "pickle"}],
        }  # fmt: skip
        (path / name / ".zarray").write_text(json.dumps(about))
        (path / name / ".zattrs").write_text(json.dumps({"_ARRAY_DIMENSIONS": ["time"]}))
        (path / name / "0").write_bytes(pickle.dumps(Code()))


# --- what reads it --------------------------------------------------------------------------------


def _viewed(path: Path) -> Any:
    page = tweezer.view(path)
    _ = page.html
    shown = {name: packed.data for name, packed in page.content.arrays.items()}
    return shown, page.content.summary, bool(page.content.warning)


def _compared(path: Path) -> Any:
    found = tweezer.compare(path, sound() / path.name)
    return found.same


def _loaded(path: Path) -> Any:
    loaded = load_result(path)
    numbers = {name: each.values.tobytes() if each.dtype.kind in "fiu" else each.values.tolist()
               for name, each in loaded.variables.items()}  # fmt: skip
    return numbers, "lost_time" in loaded and bool(np.isnan(loaded["lost_time"]).any())


def _summarised(path: Path) -> Any:
    return tweezer.summarise(tweezer.load_run(path))


def _as_scene(path: Path) -> Any:
    return tweezer.load_scene(path)


READERS: dict[str, tuple[Callable[[Path], Any], tuple[str, ...]]] = {
    "view": (_viewed, RESULTS[:-1]),
    "compare": (_compared, RESULTS),
    "load": (_loaded, RESULTS[:-2]),
    "summarise": (_summarised, RESULTS[:2]),
    "load_scene": (_as_scene, RESULTS),
    "load_recording": (tweezer.load_recording, RESULTS[1:2]),
}


@functools.cache
def _expected(reader: str, name: str) -> str:
    return repr(READERS[reader][0](sound() / name))


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    """A context in which no more than 6 GB of addresses are taken beside those that are."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + 6 * 10**9, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def results(
    count: int, first: int, seed: int, change: Callable[[np.random.Generator, Path], str]
) -> Counter[str]:
    """Read so many results that `change` has changed; see the beginning of this file."""
    for reader, (_, names) in READERS.items():  # what they need is compiled before they are timed
        for name in names:
            with contextlib.suppress(tweezer.TweezerError):  # of what is no scene
                _expected(reader, name)

    def case(rng: np.random.Generator) -> str:
        reader = str(pick(rng, list(READERS)))
        read, names = READERS[reader]
        name = str(pick(rng, names))
        path = copied(name)
        what = change(rng, path)
        before = path.lstat().st_mtime_ns if path.exists() else 0
        try:
            with _limited():
                found = repr(read(path))
            ended = "read"
        except tweezer.TweezerError as error:
            unnamed = reader != "summarise" and name not in str(error)  # it takes a dataset
            if unnamed or "\n" in str(error) or len(str(error)) > 1500:
                raise AssertionError(f"{reader} {name}, {what}: told as: {error}") from error
            ended = "refused"
        except MemoryError as error:
            raise AssertionError(f"{reader} {name}, {what}: asks for memory") from error
        except Exception as error:
            raise AssertionError(f"{reader} {name}, {what}: a traceback") from error
        if Path("code-ran").exists():
            raise AssertionError(f"{reader} {name}, {what}: ran code")
        if (path.lstat().st_mtime_ns if path.exists() else 0) != before:
            raise AssertionError(f"{reader} {name}, {what}: was changed by reading it")
        if ended == "read":
            same = found == _expected(reader, name)
            told = found.endswith("True)")  # that it is not complete
            if change is damaged and not same and not told:
                raise AssertionError(f"{reader} {name}, {what}: damaged, and called whole")
            if change is hostile and not same and not told:
                raise AssertionError(f"{reader} {name}, {what}: shows something else")
            ended = "read as it was" if same else "read, and told" if told else "read as edited"
        return f"{what}: {ended}"

    return counted(count, first, seed, case)


def damaged_results(count: int, first: int = 0) -> Counter[str]:
    """Files of results: bits changed, cut, emptied, removed, replaced."""
    return results(count, first, 11, damaged)


def edited_results(count: int, first: int = 0) -> Counter[str]:
    """Attributes, variables, descriptions and values of JSON, changed as another program may."""
    return results(count, first, 12, edited)


def hostile_results(count: int, first: int = 0) -> Counter[str]:
    """Results that name other files, run code, or declare more than they hold."""
    return results(count, first, 13, hostile)
