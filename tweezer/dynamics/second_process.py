"""A second process that compiles what the errors of a run need, while the run compiles the rest.

A run by an explicit method is compared with the unscaled equations, which another method follows.
That method takes longer to compile than all that the run itself needs, and nothing of it is
needed before the run has ended.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tweezer.compiled import Compilation, compilation, shared
from tweezer.dynamics import bind, bound_once, decided, integrate, unscaled
from tweezer.scene import Scene

#: Compile time after which the start of a second process pays, s
_WORTH = 1.0
#: Duration of the motion by which the methods are compiled, s
_MOMENT = 1e-8


@contextlib.contextmanager
def compiling_beside(scene: Scene) -> Iterator[None]:
    """Context in which a second process helps a run of `scene` to compile.

    It starts when compiling has taken a second, and ends with the context. It does not start if the
    errors require no other code, with a single processor, or on systems without file locks.
    """
    if not (_has_errors_to_compile_for(scene) and shared.POSSIBLE and _processors() > 1):
        yield
        return
    folder = Path(tempfile.mkdtemp(prefix="tweezer-"))
    process: subprocess.Popen[bytes] | None = None

    def start(compiling: Compilation) -> None:
        """Start the second process if compilation has already taken longer than `_WORTH` seconds.

        It is started only once. `compiling` gives the time that this process has spent compiling.
        """
        nonlocal process
        if process is None and compiling.seconds > _WORTH:
            shared.share(folder)
            process = _started(scene, folder)

    try:
        with compilation(start):
            yield
    finally:
        shared.share(None)
        if process is not None:
            with contextlib.suppress(OSError), process:  # which waits for it and closes its pipe
                process.kill()
        shutil.rmtree(folder, ignore_errors=True)


def _has_errors_to_compile_for(scene: Scene) -> bool:
    """Return whether the error of a run requires code that the run itself does not."""
    return not scene.forces.brownian and scene.simulation.model not in (None, "full")


def _processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _started(scene: Scene, folder: Path) -> subprocess.Popen[bytes]:
    """Return the second process, in its own session: only its parent interrupts it."""
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", __name__], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    told = {"scene": scene.model_dump_json(exclude_none=True), "folder": str(folder)}
    assert process.stdin is not None
    with contextlib.suppress(OSError):  # it has ended: what it would do remains to be done here
        process.stdin.write(json.dumps(told).encode() + b"\n")
        process.stdin.flush()
    return process


def compile_for_model_error(scene: Scene) -> None:
    """Compile the code for the model error of a run, by integrating the unscaled equations for a
    torque.
    """
    problem, _ = decided(bound_once(scene))
    compared = unscaled(problem)
    if compared is None:
        return
    moment = integrate(bind(compared), np.array([0.0, _MOMENT]))
    if moment.path is not None:
        moment.path.positions(moment.times)


def _main() -> None:
    """Compile for the scene that the first process writes to the standard input, until it closes
    it.
    """
    told = json.loads(sys.stdin.buffer.readline())
    folder = Path(told["folder"])

    def end_with_the_first_process() -> None:
        """Exit when the first process closes the pipe, which it also does by ending."""
        sys.stdin.buffer.read()  # until the other end is closed
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(0)

    threading.Thread(target=end_with_the_first_process, daemon=True).start()
    shared.share(folder)
    compile_for_model_error(Scene.model_validate_json(told["scene"]))


if __name__ == "__main__":
    _main()
