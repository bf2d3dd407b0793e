"""Computation of cases in this process, in other local processes, or on the workers of Dask."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import logging
import math
import os
import platform
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Generator, Iterator
from concurrent.futures import CancelledError, Future
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING

from tweezer.sweeps.cases import Cases
from tweezer.sweeps.quantities import FAILED, Asked, Values, to_text
from tweezer.values.errors import TweezerError
from tweezer.values.version import versions

if TYPE_CHECKING:
    from distributed import Client

#: Number of a case, with its values
Done = tuple[int, Values]
#: Cases that one worker computes in succession: their numbers and settings
Task = list[tuple[int, dict[str, str]]]

#: Number of tasks for each worker, so that all workers finish at about the same time
_TASKS = 8
#: Keys that determine the size of a bead
_SIZES = ("bead.diameter", "bead.radius")
#: Largest number of cases of a task
_LONGEST = 64
#: Number of attempts at a case whose process dies
_TRIES = 3
#: Number of tasks submitted ahead, for each worker of a cluster
_AHEAD = 2


def tasks_of(cases: Cases, of: str, left: set[int], workers: int) -> list[Task]:
    """Return the unfinished cases as tasks, the longest task first.

    For traps, a task contains cases that differ only in the power of the light, so that the force
    is computed once and then scaled. Otherwise each task is one case.

    Parameters
    ----------
    cases : Cases
        Cases of the sweep.
    of : str
        Kind of sweep.
    left : set of int
        Indices of the unfinished cases.
    workers : int
        Number of workers, on which the size of a task depends.
    """
    size = 1
    if of == "trap":
        size = min(_LONGEST, max(1, math.ceil(len(left) / (_TASKS * workers))))
    tasks = []
    for group in cases.by_light():
        kept = [case for case in group if case in left]
        tasks += [
            [(case, cases.settings(case)) for case in kept[i : i + size]]
            for i in range(0, len(kept), size)
        ]
    # the longest first, so that all workers finish at about the same time
    return sorted(tasks, key=_bead_size, reverse=True)


def _bead_size(task: Task) -> float:
    """Return the bead size of a task, m, as a measure of its duration; 0 if all cases share it."""
    _, settings = task[0]
    return max(float(settings.get(key, 0.0)) for key in _SIZES)


def cores() -> int:
    """Return the number of cores that this process may use."""
    with contextlib.suppress(AttributeError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def here(asked: Asked, tasks: list[Task]) -> Generator[Done, None, None]:
    """Compute the cases in this process, and yield each with its values."""
    for task in tasks:
        for case, settings in task:
            yield case, asked.compute(settings)


def processes(asked: Asked, tasks: list[Task], workers: int) -> Generator[Done, None, None]:
    """Compute the cases in `workers` local processes, and yield each with its values.

    The processes end when this process ends.
    """
    queue, results = deque(tasks), SimpleQueue[Done | BaseException | None]()
    keepers = [_Keeper(asked, queue, results) for _ in range(min(workers, len(tasks)))]
    try:
        for keeper in keepers:
            keeper.thread.start()
        at_work = len(keepers)
        while at_work:
            result = results.get()
            if result is None:
                at_work -= 1
            elif isinstance(result, BaseException):
                raise result
            else:
                yield result
    finally:
        queue.clear()
        for keeper in keepers:
            keeper.stop()


class _Keeper:
    """Thread that gives tasks to one process, and replaces the process if it dies.

    It puts results, or the exception that ends the thread, into a queue, and None as the last
    entry.
    """

    def __init__(
        self,
        asked: Asked,
        queue: deque[Task],
        results: SimpleQueue[Done | BaseException | None],
    ) -> None:
        """Prepare the thread without starting it.

        `asked` is the computation of each case, `queue` contains the tasks, which several threads
        share, and `results` receives the cases as they finish.
        """
        self.asked, self.queue, self.results = asked, queue, results
        self.process: subprocess.Popen[str] | None = None
        self.stopped = False
        self.changing = threading.Lock()
        self.thread = threading.Thread(target=self._run, daemon=True)

    def stop(self) -> None:
        """Kill the process, even in the middle of a case, and wait for the thread."""
        with self.changing:
            self.stopped = True
            if self.process is not None:
                self.process.kill()
        if self.thread.is_alive():
            self.thread.join()

    def _run(self) -> None:
        """Give tasks to the process until none is left; this is the body of the thread."""
        try:
            while not self.stopped:
                try:
                    task = self.queue.popleft()
                except IndexError:
                    break
                self._do(task)
        except BaseException as error:
            self.results.put(error)
        finally:
            self._end()
            self.results.put(None)

    def _do(self, task: Task) -> None:
        """Compute the cases of a task; retry a case in a new process if its process dies.

        After three deaths the case counts as failed.
        """
        left, tries = deque(task), 0
        while left and not self.stopped:
            for case, values in self._computed(list(left)):
                self.results.put((case, values))
                left.popleft()
                tries = 0
            if not left or self.stopped:
                return
            tries += 1
            if tries == _TRIES:
                code = self.process.wait() if self.process else 0
                case, _ = left.popleft()
                reason = f"its process died {_TRIES} times, last with exit status {code}"
                self.results.put((case, {"outcome": FAILED, "reason": reason}))
                tries = 0
            self._end()

    def _computed(self, task: Task) -> Iterator[Done]:
        """Yield the cases of a task as the process computes them, until it finishes or dies."""
        with self.changing:
            if self.stopped:
                return
            if self.process is None:
                self.process = _process(self.asked)
        to, of = self.process.stdin, self.process.stdout
        assert to is not None
        assert of is not None
        with contextlib.suppress(BrokenPipeError):
            to.write(json.dumps(task) + "\n")
            to.flush()
            for _ in task:
                line = of.readline()
                if not line.endswith("\n"):
                    return
                case, values = json.loads(line)
                yield case, values

    def _end(self) -> None:
        """Kill the process, if it exists, and close its pipes."""
        process, self.process = self.process, None
        if process is None:
            return
        process.kill()
        for end in (process.stdin, process.stdout):
            if end is not None:
                with contextlib.suppress(BrokenPipeError):
                    end.close()
        process.wait()


def _process(asked: Asked) -> subprocess.Popen[str]:
    """Start a process that runs `serve` for a sweep; it ends when its standard input is closed."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    process = subprocess.Popen(
        [sys.executable, "-P", "-W", "ignore", "-c",
         "from tweezer.sweeps.pool import serve; serve()"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8",
        env=environment,
    )  # fmt: skip
    assert process.stdin is not None
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(json.dumps(dataclasses.asdict(asked)) + "\n")
    return process


def serve() -> None:
    """Compute tasks in a separate process: each line of standard input is a task as JSON.

    The first line is the `Asked` of the sweep. Each case with its values is a line of output.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends this one
    logging.disable(logging.WARNING)  # otherwise each process would log that it compiles
    first = sys.stdin.readline()
    if not first:  # the parent process has ended
        return
    # results have standard output to themselves: anything else is printed to standard error
    answers: IO[str] = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    asked = Asked(**json.loads(first))
    with contextlib.suppress(BrokenPipeError):
        for line in sys.stdin:
            for case, settings in json.loads(line):
                answers.write(to_text([case, asked.compute(settings)]) + "\n")
                answers.flush()


def cluster(asked: Asked, tasks: list[Task], client: Client) -> Generator[Done, None, None]:
    """Compute the cases on the workers of a Dask scheduler, and yield each with its values."""
    from distributed import KilledWorker

    executor, ours = client.get_executor(pure=False), versions()
    width = max(1, sum(client.nthreads().values()))
    queue, ended, flying = deque(tasks), SimpleQueue[Future[list[Done]]](), 0
    try:
        while queue or flying:
            while queue and flying < _AHEAD * width:
                future = executor.submit(_there, asked, ours, queue.popleft())
                future.add_done_callback(ended.put)
                flying += 1
            yield from ended.get().result()
            flying -= 1
    except KilledWorker:
        raise TweezerError("scheduler: workers died too often; continue with resume") from None
    except CancelledError:
        raise TweezerError("scheduler: connection lost; continue with resume") from None
    finally:
        executor.shutdown(wait=False)  # cancels tasks in flight


def _there(asked: Asked, ours: dict[str, str], task: Task) -> list[Done]:
    """Compute a task on a worker of a cluster, and return its cases with their values.

    `ours` contains the versions in the process that began the sweep. Raises `TweezerError` if the
    worker has others.
    """
    for key, value in versions().items():
        if value != ours[key]:
            raise TweezerError(
                f"scheduler: worker {platform.node()} computes with another "
                f"{key.replace('_', ' ')}: {value}, not {ours[key]}"
            )
    return [(case, asked.compute(settings)) for case, settings in task]
