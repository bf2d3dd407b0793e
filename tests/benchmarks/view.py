"""Pages: size, time to write, and frames a second where no graphics card draws.

The page of a run of 2001 samples, and of an ensemble of 10,000 beads at 200 times. Frames are those
of Chromium without a window and without a graphics card, which draws in 3-D by its own program, on
as many cores as it finds; beside their number the processor time of one, of all processes of the
browser, as other programs may use the machine too.
"""

from __future__ import annotations

import math
import os
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import machine
from tests.browsing import chromium, resize

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

Results = dict[str, Any]

SCENE = "silica-1um"
SAMPLES, BEADS, TIMES = 2001, 10_000, 200
#: s of the motion of an ensemble
DURATION = 2e-3
#: Size of the window, pixels
WINDOW = (1280, 800)
#: Number of times that a page is written; the least time counts
ROUNDS = 3
#: Time for which frames are counted, s
COUNTED = 5.0


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    samples, beads, times = (101, 20, 20) if quick else (SAMPLES, BEADS, TIMES)
    driver = chromium()
    if driver is None:
        raise tweezer.TweezerError("no chromium and chromedriver on this machine")
    resize(driver, *WINDOW)
    pages = []
    try:
        with (
            tempfile.TemporaryDirectory() as name,
            warnings.catch_warnings(action="ignore", category=tweezer.PhysicsWarning),
        ):
            folder = Path(name)
            scene = tweezer.load_scene(SCENE)
            say("the page of a run")
            run = tweezer.simulate(scene.replace(simulation={"samples": samples}))
            tweezer.save_run(run, folder / "run.nc")
            pages.append({"page": f"run, {samples:,} samples", **_page(driver, folder / "run.nc")})
            say("the page of an ensemble")
            thermal = scene.replace(
                forces={"brownian": True}, optics={"evaluator": "map"},
                simulation={"model": "overdamped", "samples": times, "duration": DURATION},
            )  # fmt: skip
            tweezer.ensemble(thermal, beads, out=folder / "many.zarr")
            named = {"page": f"ensemble, {beads:,} beads, {times} times"}
            pages.append({**named, **_page(driver, folder / "many.zarr")})
    finally:
        driver.quit()
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick, "scene": SCENE, "window": list(WINDOW),
            "load_before": os.getloadavg()[0], "pages": pages,
        }
    )  # fmt: skip
    return results


def _page(driver: Chrome, result: Path) -> Results:
    """What the page of a result takes."""
    out, least = result.with_suffix(".html"), math.inf
    for _ in range(ROUNDS):
        began = time.perf_counter()
        tweezer.view(result).save(out)
        least = min(least, time.perf_counter() - began)
    driver.get(out.as_uri())
    driver.execute_async_script("setTimeout(arguments[0], 3000)")  # it settles
    driver.execute_script("tweezer.play()")
    before, frames, began = _spent(driver), _frames(driver), time.perf_counter()
    driver.execute_async_script(f"setTimeout(arguments[0], {1e3 * COUNTED})")
    drawn, passed = _frames(driver) - frames, time.perf_counter() - began
    spent = _spent(driver) - before
    said = [entry for entry in driver.get_log("browser") if entry["source"] != "network"]
    return {
        "megabytes": out.stat().st_size / 1e6,
        "written_s": least,
        "frames_per_s": drawn / passed,
        "frame_cpu_ms": 1e3 * spent / max(drawn, 1),
        "console_messages": len(said),
    }


def _frames(driver: Chrome) -> int:
    return int(driver.execute_script("return tweezer.frames()"))


def _spent(driver: Chrome) -> float:
    """Processor time of all processes of the browser so far, s."""
    processes = psutil.Process(driver.service.process.pid).children(recursive=True)
    times = [each.cpu_times() for each in processes]
    return sum(each.user + each.system for each in times)
