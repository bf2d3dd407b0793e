"""Who may import whom (pyproject.toml, import-linter)."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_import_contracts():
    linter = shutil.which("lint-imports", path=str(Path(sys.executable).parent))
    result = subprocess.run(
        [linter, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout


def test_runtime_loads_without_sympy():
    """A machine without SymPy runs scenes: nothing of the runtime imports it, even lazily."""
    program = (
        "import sys; sys.modules['sympy'] = None; sys.modules['jinja2'] = None;"
        "import tweezer; scene = tweezer.load_scene('thesis-990nm');"
        "run = tweezer.simulate(scene.replace(simulation={'samples': 2}), duration='10 us');"
        "assert run.attrs['status'] == 'complete'; assert 'derivation' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


def test_a_trap_loads_no_library_that_it_does_not_use():
    """Each of these takes 50 ms or more to import, which every command would wait for."""
    program = (
        "import sys, tweezer, tweezer.cli; tweezer.characterise('silica-1um');"
        "slow = ('scipy.linalg', 'scipy.stats', 'scipy.optimize', 'matplotlib', 'xarray', 'dask');"
        "print(*(each for each in slow if each in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout.strip() == ""
