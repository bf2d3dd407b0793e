"""What is compiled is kept, also where tweezer cannot be written; it is told, and done ahead."""

from __future__ import annotations

import gc
import hashlib
import importlib.util
import os
import pkgutil
import re
import resource
import shutil
import subprocess
import sys
import threading
from collections import namedtuple
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numba
import pytest
from numba.core import event
from numba.core.dispatcher import Dispatcher
from rich.console import Console

import tweezer
from tweezer import cli
from tweezer.beads.thermal import Coupled
from tweezer.cli import warmup
from tweezer.cli.warmup import usual_scenes
from tweezer.compiled import cache, compilation, compiling, fingerprint, named_njit
from tweezer.dynamics import bind
from tweezer.dynamics.solution import Solver
from tweezer.dynamics.walk import Walk

ROOT = Path(__file__).parents[2]
NOTICE = "compiling, once: the next runs load it (`tweezer warmup` does it in advance)"
#: the command line, which does not wait with its notice
COMMAND = """
from tweezer import cli
from tweezer.compiled import compiling
compiling._PATIENCE = 0
cli.main()
"""
THEN_WARMUP = """
import sys
try:
    from tweezer import cli
    from tweezer.compiled import compiling
    compiling._PATIENCE = 0
    cli.main()
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
from tweezer.compiled import address, cached_njit

def made(number):
    @cached_njit()
    def add(x):
        return x + number
    return add

kernels = [made(int(each)) for each in sys.argv[1:]]
called = [kernel(0.0) for kernel in kernels]
addresses = [address(kernel, numba.float64(numba.float64)) for kernel in kernels]
of = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)
print(*called, *(of(each)(0.0) for each in addresses))
"""

#: the force of the thesis's rays, whose sum is rounded as it was optimised
FORCE = """
import numpy as np, tweezer
places = 1e-6 * np.random.default_rng(1).uniform(-2, 2, (200, 3))
print(tweezer.optical_force(tweezer.load_scene("thesis-1950nm"), places).tobytes().hex())
import sys
print("numba.np.arrayobj" in sys.modules, file=sys.stderr)
"""

#: a function of another library, kept by Numba; and what tweezer leaves of Numba's insides
FOREIGN = """
import sys
if "tweezer" in sys.argv:
    import tweezer.optics.rays.quadrature
import itertools, numba
from numba.core import bytecode, caching

@numba.njit(cache=True)
def twice(x):
    return 2 * x

assert twice(2.0) == 4.0
cache = twice._cache
print(sum(twice.stats.cache_hits.values()), numba.config.CACHE_LOCATOR_CLASSES,
      *(type(each).__module__ for each in (cache, cache._cache_file)),
      caching.IndexDataCacheFile.__module__, type(bytecode.FunctionIdentity._unique_ids).__name__)
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
    assert not any("turn_over" in name for name in kept)  # it does not rotate

    again = command("run", "mine.toml", program=THEN_WARMUP)
    assert "wrote mine.nc" in again.stdout
    assert NOTICE not in again.stderr
    assert compiled(cache) == kept
    found = int(re.search(r"compiled 0 functions in 0 s; (\d+) were there already$",
                          again.stdout)[1])  # fmt: skip
    assert 0 < found <= len(kept)  # one that another calls is compiled within it


def test_what_is_compiled_and_what_is_found_round_alike(tmp_path):
    """Loading compiled code imports no module of Numba that only its compiler needs."""
    first, second = (
        python("-W", "ignore", "-c", FORCE, cwd=ROOT, NUMBA_CACHE_DIR=str(tmp_path))
        for _ in range(2)
    )
    assert first.stdout == second.stdout
    assert first.stderr.splitlines()[-1] == "True"
    assert second.stderr == "False\n"


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
    assert "compiled functions cannot be stored" in said[0]
    assert not list(temporary.iterdir())


def begun(function):
    """What Numba tells as it compiles `function`, until the context ends."""
    dispatcher = SimpleNamespace(py_func=function, stats=SimpleNamespace(cache_path="/"))
    return event.trigger_event("numba:compile", data={"dispatcher": dispatcher})


def test_only_what_is_of_tweezer_is_told():
    ours, called = tweezer.load_scene, tweezer.optics.light_force
    told = []
    with compilation(lambda compiling: told.append(compiling.latest)) as compiling:
        with begun(test_only_what_is_of_tweezer_is_told), begun(ours):
            pass
        with begun(ours), begun(called):
            pass
    assert told == ["load.load_scene", "load.load_scene", "binding.light_force"]
    assert compiling.functions == 3


@pytest.mark.parametrize("before", [True, False])
def test_no_garbage_is_looked_for_while_compiling_and_then_as_before(before):
    seen = []

    class Looking(event.Listener):
        def on_start(self, _):
            seen.append(gc.isenabled())

        def on_end(self, _):
            seen.append(gc.isenabled())

    inner = numba.njit(lambda x: x + 1)
    failing = numba.njit(lambda x: inner(x) + "text")
    enabled = gc.isenabled()
    try:
        (gc.enable if before else gc.disable)()
        with event.install_listener("numba:compile", Looking()), pytest.raises(numba.TypingError):
            failing(1)
        assert gc.isenabled() == before
    finally:
        (gc.enable if enabled else gc.disable)()
    assert seen[:3] == [False] * 3


def test_what_only_compiled_functions_call_refuses_python_also_once_it_is_compiled():
    inner = named_njit(inner=True)(lambda x: 2 * x)
    outer = numba.njit(lambda x: inner(x) + 1)
    for _ in range(2):
        with pytest.raises(TypeError, match="only compiled functions can call it"):
            inner(3)
        assert outer(3) == 7


def test_what_is_linked_finds_its_python_objects(capfd):
    @named_njit(inner=True)
    def tell(x):
        print("told", x)
        return x

    @named_njit()
    def call(x):
        return tell(x)

    assert call(2.0) == 2.0
    assert capfd.readouterr().out == "told 2.0\n"


@pytest.mark.parametrize("first", ["compiled", "Python"])
def test_a_function_serves_compiled_code_and_python_in_any_order(tmp_path, first):
    """Also from the files that another process has kept."""
    lines = f"""
from numba import float64, types
from tweezer.compiled import address, cached_njit, call

@cached_njit()
def twice(x):
    return 2 * x

@cached_njit()
def write(x, out):
    out[0] = twice(x)

WRITE = types.void(float64, float64[::1])
import numpy as np
out = np.zeros(1)

@cached_njit()
def by_address(at, x, out):
    call(at, (x, out))

@cached_njit()
def compiled(x, out):
    write(x, out)
    return twice(x) + out[0]

ways = {{
    "compiled": lambda: compiled(1.5, out) == 6.0,
    "Python": lambda: twice(1.5) == 3.0,
    "address": lambda: by_address(address(write, WRITE), 1.5, out) is None and out[0] == 3.0,
}}
print([bool(ways[name]()) for name in ({first!r}, *ways, *ways)])
"""
    (tmp_path / "tweezer_user.py").write_text(lines)
    for _ in range(2):
        done = python("tweezer_user.py", cwd=tmp_path, PYTHONPATH=str(ROOT),
                      NUMBA_CACHE_DIR=str(tmp_path / "kept"))  # fmt: skip
        assert done.stdout == f"{[True] * 7}\n", done.stderr


def test_time_is_counted_once(monkeypatch):
    """Of a function and of what it calls; and not between two functions."""
    now = 0.0
    monkeypatch.setattr("tweezer.compiled.compiling.time.perf_counter", lambda: now)
    with compilation(lambda compiling: None) as compiling:
        with begun(tweezer.load_scene):
            now += 1
            with begun(tweezer.optics.light_force):
                now += 2
                assert compiling.seconds == 3
            now += 4
        now += 8
        with begun(tweezer.load_scene):
            now += 16
    assert compiling.seconds == 1 + 2 + 4 + 16


@pytest.mark.parametrize(
    ("of", "name", "scene", "brownian"),
    [(Walk, "filmed", "silica-1um", True), (Solver, "advance", "silica-1um", False),
     (Coupled, "take_steps", "two-beads", True)], ids=["walk", "solver", "several beads"],
)  # fmt: skip
def test_stepping_is_without_compiling(monkeypatch, of, name, scene, brownian):
    now, stepping = 0.0, getattr(of, name)

    def compiles_first(*arguments):
        nonlocal now
        with begun(tweezer.load_scene):
            now += 1e-3
        now += 2e-3
        return stepping(*arguments)

    monkeypatch.setattr("time.perf_counter", lambda: now)
    monkeypatch.setattr(of, name, compiles_first)
    run = tweezer.simulate(
        tweezer.load_scene(scene).replace(
            forces={"brownian": brownian}, simulation={"duration": "1 ms", "samples": 3}
        )
    )
    assert run.attrs["compile_time"] == pytest.approx(1e-3)
    assert run.attrs["step_time"] == pytest.approx(2e-3)
    assert run.attrs["wall_time"] == pytest.approx(2e-3)


def test_a_bar_tells_what_is_compiled(monkeypatch, capsys):
    console = Console(stderr=True, force_terminal=True, width=120)
    monkeypatch.setattr(cli.console, "ERR", console)
    with cli.console.showing_progress("a bead", 1.0) as progress:
        with begun(tweezer.load_scene):
            pass
        progress(0.5)
    assert re.search(r"a bead \(compiling, once: \d+ s so far\)", capsys.readouterr().err)


def test_every_scene_that_is_shipped_is_warmed_up_as_it_is():
    for name in tweezer.shipped_scenes():
        scene = tweezer.load_scene(name)
        assert scene in usual_scenes(scene)


def test_both_theories_and_fits_of_the_depth_are_warmed_up(monkeypatch):
    """All the kinds of light that a kernel or a loop is compiled for, without compiling them."""
    fields, filters = set(), set()

    class Seen:
        def __init__(self, scene):
            beam = scene.beam.polarisation
            self.scene, self.kind = scene, (scene.theory, beam, scene.optics.evaluator)

        def field(self, positions, *, gradient):
            fields.add((*self.kind, gradient))

    monkeypatch.setattr(warmup, "light_of_one_beam", Seen)
    monkeypatch.setattr(warmup, "bound_once", lambda scene: scene)
    monkeypatch.setattr(warmup, "bind_translation", lambda scene, model: scene)
    monkeypatch.setattr(warmup, "kalman_filter", lambda scene: filters.add(scene.optics.evaluator))
    monkeypatch.setattr(warmup, "walk", lambda scene: SimpleNamespace(scene=scene))
    monkeypatch.setattr(warmup, "chosen", lambda scene: (scene, ""))
    monkeypatch.setattr(warmup, "simulate", lambda scene: None)
    for name in tweezer.shipped_scenes():
        for scene in usual_scenes(tweezer.load_scene(name)):
            warmup.warm_up(scene)
    assert filters == {"grid", "auto", "map"}
    for gradient in (False, True):
        for evaluator in ("map", "quadrature"):
            assert ("waves", "circular", evaluator, gradient) in fields
            assert ("waves", "linear", evaluator, gradient) in fields
        assert ("rays", "averaged-reflectance", "grid", gradient) in fields
        for evaluator in ("map", "quadrature"):
            assert ("rays", "averaged-reflectance", evaluator, gradient) in fields


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


def test_functions_of_other_libraries_are_left_to_numba(tmp_path):
    (tmp_path / "foreign.py").write_text(FOREIGN, encoding="utf-8")

    def said(*arguments):
        return python("foreign.py", *arguments, cwd=tmp_path, PYTHONPATH=str(ROOT)).stdout.split()

    numbas = ["numba.core.caching"] * 3 + ["count"]
    assert said("tweezer") == ["0", *numbas]
    assert said() == ["1", *numbas]
    assert {path.suffix for path in (tmp_path / "__pycache__").iterdir()} == {".nbi", ".nbc"}


def test_what_tweezer_keeps_it_keeps_in_its_own_files():
    for module in pkgutil.walk_packages(tweezer.__path__, "tweezer."):
        if module.name != "tweezer.__main__":
            importlib.import_module(module.name)
    bind(tweezer.load_scene("thesis-990nm"))
    kept = [
        each
        for each in gc.get_objects()
        if issubclass(type(each), Dispatcher)  # `isinstance` fails for what a weak reference lost
        and str(each.py_func.__module__).startswith("tweezer.")
        and each.stats.cache_path is not None
    ]
    bound = ("ray", "kinematics", "scaled_translation")
    ours = [
        each
        for each in kept
        if not (path := each.py_func.__module__).startswith("tweezer.generated")
        or path.rpartition(".")[2] in bound
    ]
    assert len(ours) > 50
    assert {type(each._cache) for each in ours} == {cache._Cache}


def told(*programs, hash_seed="0"):
    """Fingerprint of the `loop` of each program, all in one process."""
    lines = f"""
from tweezer.compiled import fingerprint
for program in {programs}:
    names = {{"__name__": "__main__"}}
    exec(program, names)
    print(fingerprint(names["loop"]))
"""
    done = python("-c", lines, cwd=ROOT, PYTHONPATH=str(ROOT), PYTHONHASHSEED=hash_seed)
    return done.stdout.split()


CALLING = """
import math
import numpy as np
from numba import njit
import tweezer.dynamics.brownian.noise as noise

LIMITS = np.array([1.0, 2.0])
SET = frozenset({"a", "b", "c"})

def made(factor):
    @njit
    def inner(x):
        return factor * x
    return inner

@njit(fastmath={"nnan", "ninf", "nsz", "arcp"})
def step(x):
    return math.sin(x) + LIMITS[0]

twice = made(2)

@njit
def loop(x):
    return step(twice(x)) + noise._LN_2
"""


#: each changes what the loop does
CHANGES = [
    ("math.sin", "math.cos"),
    ("1.0, 2.0", "1.0, 2.5"),
    ("made(2)", "made(3)"),
    ('"nnan", ', ""),
    ("step(twice(x))", "twice(step(x))"),
    ("factor * x", "factor + x"),
    ("noise._LN_2", "noise._BIAS"),
]


def test_a_change_of_what_is_called_is_seen():
    assert all(old in CALLING for old, _ in CHANGES)
    fingerprints = told(CALLING, *(CALLING.replace(*change) for change in CHANGES))
    assert len(set(fingerprints)) == 1 + len(CHANGES)


def test_what_nothing_calls_changes_nothing():
    changed = CALLING.replace("SET =", "import os\nOTHER =") + "\ndef other(x): return x\n"
    assert told(CALLING) == told(changed, hash_seed="1")


def test_what_cannot_be_compared_is_refused():
    strange = object()

    def closure():
        return strange

    with pytest.raises(TypeError, match="cannot be detected"):
        fingerprint(closure)


def test_the_order_of_a_tuple_s_names_is_part_of_its_type(tmp_path):
    """Code reads a value by the place of its name."""
    types = [
        numba.typeof(namedtuple("Pair", names)(1.0, 2.0)) for names in ("near far", "far near")
    ]
    assert repr(types[0]) == repr(types[1])
    paths = {file_of(tmp_path).path(((each, numba.float64), ("processor",))) for each in types}
    nested = {
        file_of(tmp_path).path(((numba.types.Tuple((each,)),), ("processor",))) for each in types
    }
    assert len(paths) == len(nested) == 2


#: Numba's key of a function of that argument
def under(kind):
    return (kind, ("processor",))


def file_of(folder, compiled_from="") -> cache._File:
    return cache._File(str(folder / "function"), compiled_from)


def test_code_of_other_sources_is_not_found_and_replaced(tmp_path):
    file_of(tmp_path, "old").save(under("grid"), "old code")
    new = file_of(tmp_path, "new")
    assert new.load(under("grid")) is None
    new.save(under("grid"), "new code")
    new.save(under("map"), "code of map")
    assert new.load(under("grid")) == "new code"
    assert new.load(under("map")) == "code of map"
    assert len(list(tmp_path.iterdir())) == 2


def test_an_interrupted_process_leaves_nothing(tmp_path, monkeypatch):
    def stopped(self, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        file_of(tmp_path).save(under("grid"), "code")
    assert list(tmp_path.iterdir()) == []


class Alike(type):
    """Types that Numba writes alike."""

    def __repr__(cls):
        return "NamedTuple(float64 x 2)"


def test_types_of_equal_names_do_not_share_code(tmp_path, monkeypatch):
    """And one whose program is not there is compiled again."""
    program = ModuleType("program")
    for name in ("Spring", "Bowl"):
        setattr(program, name, Alike(name, (), {"__module__": "program"}))
    file = file_of(tmp_path)
    monkeypatch.setitem(sys.modules, "program", program)
    file.save(under(program.Spring), "code for springs")
    assert file.load(under(program.Spring)) == "code for springs"
    assert file.load(under(program.Bowl)) is None
    monkeypatch.undo()
    assert file.load(under(program.Spring)) is None


def test_a_file_that_two_replace_is_always_whole(tmp_path):
    codes = ["a" * 50_000, "b" * 100_000]

    def keep(code):
        for _ in range(100):
            file_of(tmp_path).save(under("grid"), code)

    threads = [threading.Thread(target=keep, args=(code,)) for code in codes]
    for thread in threads:
        thread.start()
    found = set()
    while any(thread.is_alive() for thread in threads):
        found.add(file_of(tmp_path).load(under("grid")))
    assert found <= {None, *codes}
    assert file_of(tmp_path).load(under("grid")) in codes
    assert len(list(tmp_path.iterdir())) == 1


@pytest.fixture
def function(tmp_path, monkeypatch):
    """A function of a module of its own, compiled as often as it is called."""
    path = tmp_path / "small.py"
    path.write_text("def twice(x):\n    return 2 * x\n", encoding="utf-8")
    spec = importlib.util.spec_from_file_location(f"small_{tmp_path.name}", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    spec.loader.exec_module(module)

    def compiled_again():
        twice = cache.cached_njit()(module.twice)
        assert twice(2.0) == 4.0
        return sum(twice.stats.cache_hits.values()), Path(twice.stats.cache_path)

    return compiled_again


def flip(content: bytes) -> bytes:
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


@pytest.mark.parametrize(
    "damaged", [lambda content: b"", lambda content: content[:1000], flip], ids=["no", "cut", "bit"]
)
def test_damaged_code_is_compiled_again(function, damaged):
    hits, folder = function()
    assert hits == 0
    assert function()[0] == 1
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(damaged(whole))
    assert function()[0] == 0
    assert function()[0] == 1  # the file written again is sound
    assert list(folder.iterdir()) == [file]


def test_without_room_for_it_what_is_compiled_is_not_kept(function):
    compiling.not_kept.cache_clear()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)

    def twice_without_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
        try:
            return function()[0] + function()[0]
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)

    with pytest.warns(UserWarning, match="cannot be stored: File too large") as warned:
        assert twice_without_room() == 0
    assert len(warned) == 1
    assert function()[0] == 0
    assert function()[0] == 1
