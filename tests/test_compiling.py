"""What is compiled is kept, also where tweezer cannot be written; it is told, and done ahead."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from numba.core import caching, event

import tweezer
from tweezer import cli, compiling
from tweezer.compiling import compilation
from tweezer.warmup import usual_scenes

ROOT = Path(__file__).parents[1]
NOTICE = "compiling, once: the next runs load it (`tweezer warmup` does it ahead)"
#: the command line, which does not wait with its notice
COMMAND = "from tweezer import cli, compiling; compiling._PATIENCE = 0; cli.main()"
THEN_WARMUP = """
import sys
try:
    from tweezer import cli, compiling; compiling._PATIENCE = 0; cli.main()
except SystemExit:
    sys.argv[1:] = ["warmup", "mine.toml"]; cli.main()
"""
#: thermal motion without light: of all motions what compiles soonest
DARK = tweezer.shipped_scenes()["silica-1um"].read_text(encoding="utf-8").replace(
    'model = "full"', 'model = "overdamped"'
) + "samples = 11\n[forces]\nbrownian = true\noptical = false\n"  # fmt: skip
#: one small function, compiled
PROGRAM = """
import numpy as np
import tweezer
from tweezer.dynamics.brownian.noise import normals
numbers = np.empty((3, 2))
normals(1, np.arange(2), 0, 0, numbers)
tweezer.load_scene("silica-1um")
print(numbers.tolist())
"""

#: variants of one function, called as the kernels of the light are
VARIANTS = """
import ctypes, sys
import numba
from tweezer.dynamics.integrators import Pointer

def made(number):
    @numba.njit(cache=True)
    def add(x):
        return x + number
    return add

kernels = [made(int(each)) for each in sys.argv[1:]]
called = [kernel(0.0) for kernel in kernels]
pointers = [Pointer(kernel, numba.float64(numba.float64)) for kernel in kernels]
of = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)
print(*called, *(of(pointer.__wrapper_address__())(0.0) for pointer in pointers))
"""


def python(*arguments, cwd, **environment):
    """Run Python without the caches of this session."""
    inherited = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=cwd, env=inherited | environment, capture_output=True,
        text=True, check=True,
    )  # fmt: skip


def compiled(folder: Path) -> dict[str, str]:
    """Digest of every file that Numba keeps in `folder`, by name."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*.nb[ic]")
    }


def test_after_a_warm_up_a_run_compiles_nothing(tmp_path):
    cache = tmp_path / "cache"
    (tmp_path / "mine.toml").write_text(DARK, encoding="utf-8")

    def command(*arguments, program=COMMAND):
        return python(
            "-c", program, *arguments, cwd=tmp_path,
            PYTHONPATH=str(ROOT), NUMBA_CACHE_DIR=str(cache),
        )  # fmt: skip

    first = command("warmup", "mine.toml")
    functions = int(re.fullmatch(
        r"compiled (\d+) functions in \d+ s; 0 were there already\n", first.stdout
    )[1])  # fmt: skip
    assert functions > 2
    assert first.stderr.splitlines() == [NOTICE]
    kept = compiled(cache)
    assert len(kept) > 2

    again = command("run", "mine.toml", program=THEN_WARMUP)
    assert "wrote mine.nc" in again.stdout
    assert NOTICE not in again.stderr
    assert compiled(cache) == kept
    found = int(re.search(r"compiled 0 functions in 0 s; (\d+) were there already$",
                          again.stdout)[1])  # fmt: skip
    assert 0 < found <= functions


@pytest.fixture
def unwritable(tmp_path) -> Path:
    """A copy of tweezer in which nothing can be kept, whoever asks."""
    for name in ("tweezer", "generated"):
        copy = shutil.copytree(
            ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__")
        )
        for folder in (copy, *(path for path in copy.rglob("*") if path.is_dir())):
            (folder / "__pycache__").touch()
    return tmp_path


def test_what_cannot_be_kept_beside_the_sources_is_kept_for_the_user(unwritable):
    user, own = unwritable / "user", unwritable / "own"
    done = python("-c", PROGRAM, cwd=unwritable, XDG_CACHE_HOME=str(user))
    assert "NUMBA_CACHE_DIR" not in done.stderr
    assert compiled(user)
    chosen = python(
        "-c", PROGRAM, cwd=unwritable, XDG_CACHE_HOME=str(unwritable), NUMBA_CACHE_DIR=str(own)
    )
    assert chosen.stdout == done.stdout
    assert compiled(own).keys() != compiled(user).keys()  # numba's own choice of folders
    assert len(compiled(own)) == len(compiled(user))


def test_without_a_place_to_keep_it_everything_works_and_says_so(unwritable):
    nowhere, temporary = unwritable / "nowhere", unwritable / "temporary"
    nowhere.touch()
    temporary.mkdir()
    done = python("-c", PROGRAM, cwd=unwritable, XDG_CACHE_HOME=str(nowhere), TMPDIR=str(temporary))
    assert done.stdout.startswith("[[")
    said = [line for line in done.stderr.splitlines() if "NUMBA_CACHE_DIR" in line]
    assert len(said) == 1
    assert "what is compiled is not kept" in said[0]
    assert not list(temporary.iterdir())


def begun(function):
    """What Numba tells as it compiles `function`, until the context ends."""
    dispatcher = SimpleNamespace(py_func=function, stats=SimpleNamespace(cache_path="/"))
    return event.trigger_event("numba:compile", data={"dispatcher": dispatcher})


def test_only_what_is_of_tweezer_is_told():
    ours, called = tweezer.load_scene, tweezer.optics.light
    told = []
    with compilation(lambda compiling: told.append(compiling.latest)) as compiling:
        with begun(test_only_what_is_of_tweezer_is_told), begun(ours):
            pass
        with begun(ours), begun(called):
            pass
    assert told == ["scene.load_scene", "scene.load_scene", "light.light"]
    assert compiling.functions == 3


def test_time_is_counted_once(monkeypatch):
    """Of a function and of what it calls; and not between two functions."""
    now = 0.0
    monkeypatch.setattr("tweezer.compiling.time.perf_counter", lambda: now)
    with compilation(lambda compiling: None) as compiling:
        with begun(tweezer.load_scene):
            now += 1
            with begun(tweezer.optics.light):
                now += 2
                assert compiling.seconds == 3
            now += 4
        now += 8
        with begun(tweezer.load_scene):
            now += 16
    assert compiling.seconds == 1 + 2 + 4 + 16


def test_a_bar_tells_what_is_compiled(monkeypatch, capsys):
    console = cli.Console(stderr=True, force_terminal=True, width=120)
    monkeypatch.setattr(cli, "_err", console)
    with cli._progress("a bead", 1.0) as progress:
        with begun(tweezer.load_scene):
            pass
        progress(0.5)
    assert re.search(r"a bead \(compiling, once: \d+ s so far\)", capsys.readouterr().err)


def test_every_scene_that_is_shipped_is_warmed_up_as_it_is():
    for name in tweezer.shipped_scenes():
        scene = tweezer.load_scene(name)
        assert scene in usual_scenes(scene)


def test_variants_kept_at_once_are_each_their_own(tmp_path):
    """Two keep a variant of one function each: both have read the index before either writes it."""
    both = threading.Barrier(2)

    class Slow(caching.IndexDataCacheFile):
        def _load_index(self):
            index = super()._load_index()
            with contextlib.suppress(threading.BrokenBarrierError):  # by whoever has to wait
                both.wait(timeout=0.5)
            return index

    def keep(variant):
        Slow(str(tmp_path), "function", "stamp").save(variant, f"code of {variant}")

    threads = [threading.Thread(target=keep, args=(variant,)) for variant in ("grid", "map")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    kept = caching.IndexDataCacheFile(str(tmp_path), "function", "stamp")
    assert {each: kept.load(each) for each in ("grid", "map")} == {
        "grid": "code of grid", "map": "code of map",
    }  # fmt: skip


def test_what_is_kept_after_an_interruption_is_not_older_code(tmp_path):
    """A source was edited, and the first that keeps its new code is stopped on the way."""

    def files(stamp):
        return caching.IndexDataCacheFile(str(tmp_path), "function", stamp)

    files("old").save("grid", "old code of grid")

    class Stopped(caching.IndexDataCacheFile):
        def _save_data(self, name, data):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Stopped(str(tmp_path), "function", "new").save("map", "code of map")
    assert files("new").load("map") is None
    files("new").save("map", "code of map")
    files("new").save("map", "the same again")
    assert files("new").load("map") == "the same again"
    assert len(list(tmp_path.glob("*.nbc"))) == 1


def test_variants_kept_by_two_processes_are_each_their_own(tmp_path):
    """A loop is given a kernel by the address of its machine code, which is found by its name."""
    (tmp_path / "variants.py").write_text(VARIANTS, encoding="utf-8")
    cache = str(tmp_path / "cache")
    for numbers, said in (("1", "1.0"), ("2", "2.0"), ("12", "1.0 2.0"), ("21", "2.0 1.0")):
        done = python(
            "variants.py", *numbers, cwd=tmp_path, PYTHONPATH=str(ROOT), NUMBA_CACHE_DIR=cache,
            PYTHONHASHSEED="0",  # or the names differ by chance
        )  # fmt: skip
        assert done.stdout.split() == 2 * said.split()
    assert len(list(Path(cache).rglob("*.nbc"))) == 2


def test_an_index_that_names_what_is_gone_is_begun_anew(tmp_path, monkeypatch):
    """A variant for a program's own type: without that program it cannot be read."""
    program = ModuleType("program")
    program.Spring = type("Spring", (), {"__module__": "program"})
    files = caching.IndexDataCacheFile(str(tmp_path), "function", "stamp")
    monkeypatch.setitem(sys.modules, "program", program)
    files.save(program.Spring, "code for springs")
    files.save("grid", "code of grid")
    assert files.load("grid") == "code of grid"
    del program.Spring
    assert files.load("grid") is None
    monkeypatch.undo()
    assert files.load("grid") is None
    files.save("grid", "code of grid, again")
    assert files.load("grid") == "code of grid, again"


@pytest.mark.parametrize("error", [OSError, NotImplementedError])
def test_where_files_cannot_be_locked_nothing_is_kept(tmp_path, monkeypatch, error):
    files = caching.IndexDataCacheFile(str(tmp_path), "function", "stamp")
    files.save("grid", "code")

    def refuse(self, **options):
        raise error

    monkeypatch.setattr(compiling.FileLock, "acquire", refuse)
    files.save("map", "code")
    assert files.load("grid") is None
    monkeypatch.undo()
    assert files.load("grid") == "code"
    assert files.load("map") is None
