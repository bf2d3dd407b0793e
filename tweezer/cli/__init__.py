"""Command line. Large libraries are imported only when a command needs them."""

from __future__ import annotations

import _thread
import errno
import importlib
import os
import signal
import sys
import threading
import warnings
from typing import Annotated, Any

import typer

from tweezer.cli.app import app
from tweezer.cli.completion import answer_bash
from tweezer.cli.console import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    OUT,
    complain,
    show_warning,
    tell_interrupted,
)
from tweezer.values.errors import TweezerError

__all__ = ["app", "main"]

# in the order of the help page
for _group in (
    "new",
    "runs",
    "view",
    "trap",
    "detect",
    "optimise",
    "ensemble",
    "sweep",
    "rotation",
    "compare",
    "examples",
    "calibrate",
    "rheology",
    "fit",
    "depth",
    "stretch",
    "thesis",
    "prepare",
    "info",
    "bench",
):
    importlib.import_module(f"tweezer.cli.{_group}")


#: Time after which an interrupt that Python ignored is repeated, s
_ONCE_MORE = 0.05


def main() -> None:
    """Run the command line; an expected error prints one line and gives exit code 2.

    SIGTERM and SIGHUP are treated as an interruption, so results so far are written.
    """
    warnings.showwarning = show_warning  # type: ignore[assignment]
    sys.unraisablehook = _interrupt_again
    # matrices are small here: starting threads for them takes longer than they save
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # pydantic would otherwise search all installed packages for plugins
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    for number in {signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)}:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    if os.environ.get("_TWEEZER_COMPLETE") == "complete_bash":
        return answer_bash(app)
    try:
        app()
    except TweezerError as error:
        complain(str(error))
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:  # before a command began
        tell_interrupted()
        sys.exit(INTERRUPTED)
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        complain(f"cannot write to standard output: {error.strerror}")
        os._exit(FAILED)  # without another flush of the output by the interpreter


def _interrupt_again(unraisable: Any) -> None:
    """Repeat an interrupt that Python ignored, for example in a callback of Numba's compiler."""
    if unraisable.exc_type is KeyboardInterrupt:
        threading.Timer(_ONCE_MORE, _thread.interrupt_main).start()
    else:
        sys.__unraisablehook__(unraisable)


def _version(asked: bool) -> None:
    if asked:
        from tweezer.values.version import __version__

        OUT.print(f"tweezer {__version__}", highlight=False)
        raise typer.Exit


@app.callback()
def _commands(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass
