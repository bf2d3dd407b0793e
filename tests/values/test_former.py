"""Import paths of earlier releases give the same objects and one warning with the new path."""

import importlib
import pickle
import subprocess
import sys

import pytest

import tweezer
from tweezer.values import former


@pytest.mark.parametrize("old", former._NEW)
def test_module_is_found_by_old_path(old):
    new = former._NEW[old]
    sys.modules.pop(old, None)
    with pytest.warns(FutureWarning, match=f"^{old}: has moved to {new}; the old path"):
        module = importlib.import_module(old)
    assert module is importlib.import_module(new)
    assert module.__spec__.name == new


def test_names_of_the_former_package_analysis():
    analysis = importlib.import_module("tweezer.analysis")
    heirs = [importlib.import_module(f"tweezer.{heir}") for heir in former._HEIRS]
    for name in ("Calibration", "Recording", "Trap", "fit_depth", "summarise", "escape_times"):
        with pytest.warns(FutureWarning, match=rf"^tweezer\.analysis\.{name}: has moved to"):
            found = getattr(analysis, name)
        assert found in [getattr(heir, name, None) for heir in heirs]
    with pytest.raises(AttributeError, match="no attribute 'calibrat'"):
        _ = analysis.calibrat


SCRIPT = """
import warnings
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("default")
    import tweezer
    assert not said
    from tweezer.analysis import Recording
    from tweezer.analysis.calibration import Calibration
    from tweezer import style, units
    tweezer.errors.SceneError
    from tweezer.scene import Scene
    lines = [(each.lineno, str(each.message).partition(";")[0]) for each in said]
    files = {each.filename for each in said}
    assert files == {__file__}, files
assert tweezer.Calibration is Calibration and tweezer.Scene is Scene
assert tweezer.errors.SceneError is tweezer.SceneError
print(*(f"{line} {text}" for line, text in lines), sep="\\n")
"""


def test_each_import_of_an_old_path_warns_with_its_new_path(tmp_path):
    file = tmp_path / "script.py"
    file.write_text(SCRIPT)
    done = subprocess.run([sys.executable, file], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [
        "7 tweezer.analysis.Recording: has moved to tweezer.reading.Recording",
        "8 tweezer.analysis.calibration: has moved to tweezer.calibration.calibration",
        "9 tweezer.style: has moved to tweezer.plots.style",
        "9 tweezer.units: has moved to tweezer.values.units",
        "10 tweezer.errors: has moved to tweezer.values.errors",
    ]


def test_scene_pickled_under_old_path_is_read():
    scene = tweezer.load_scene("thesis-990nm")
    old = pickle.dumps(scene, protocol=0).replace(b"tweezer.scene.scene", b"tweezer.scene")
    assert pickle.loads(old) == scene
