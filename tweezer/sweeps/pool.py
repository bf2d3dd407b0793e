"""Computing cases: in this process, in others on this machine, or on the workers of Dask."""

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

#: A case and what became of it
Done = tuple[int, Values]
#: Cases that one worker computes one after the other: their numbers and settings
Task = list[tuple[int, dict[str, str]]]

#: Number of tasks for each worker, so that all end at about the same time
_TASKS = 8
#: Keys of the size of a bead
_SIZES = ("bead.diameter", "bead.radius")
#: Largest number of cases of a task
_LONGEST = 64
#: Number of times that a case is tried whose process dies
_TRIES = 3
#: Number of tasks in flight for each worker of a cluster
_AHEAD = 2


def tasks_of(cases: Cases, of: str, left: set[int], workers: int) -> list[Task]:
    """The cases that are `left`, in tasks; those of a trap keep to a light.

    Its force, but for a factor, is then computed once for all its powers.
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
    # the longest first, so that all workers end at about the same time
    return sorted(tasks, key=_bead_size, reverse=True)


def _bead_size(task: Task) -> float:
    """Size of the bead, if the sweep is over it: larger ones take longer."""
    _, settings = task[0]
    return max(float(settings.get(key, 0.0)) for key in _SIZES)


def cores() -> int:
    """Number of cores that this process may use."""
    with contextlib.suppress(AttributeError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def here(asked: Asked, tasks: list[Task]) -> Generator[Done, None, None]:
    """Compute in this process."""
    for task in tasks:
        for case, settings in task:
            yield case, asked.compute(settings)


def processes(asked: Asked, tasks: list[Task], workers: int) -> Generator[Done, None, None]:
    """Compute in processes of this machine, which end when this one does."""
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
    """A thread that hands tasks to a process; one that dies is replaced."""

    def __init__(
        self,
        asked: Asked,
        queue: deque[Task],
        results: SimpleQueue[Done | BaseException | None],
    ) -> None:
        self.asked, self.queue, self.results = asked, queue, results
        self.process: subprocess.Popen[str] | None = None
        self.stopped = False
        self.changing = threading.Lock()
        self.thread = threading.Thread(target=self._run, daemon=True)

    def stop(self) -> None:
        """End the process, whatever it does."""
        with self.changing:
            self.stopped = True
            if self.process is not None:
                self.process.kill()
        if self.thread.is_alive():
            self.thread.join()

    def _run(self) -> None:
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
        """Compute a task; a case whose process dies is tried again, in a fresh one."""
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
        """What the process says of a task, up to the end or to its death."""
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
    """A process that runs `serve`; it ends when its standard input does."""
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
    """Compute the tasks that standard input has a line for, each case to a line of output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that began this one ends it
    logging.disable(logging.WARNING)  # each process would tell that it compiles
    first = sys.stdin.readline()
    if not first:  # the process that began this one has ended
        return
    answers: IO[str] = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    asked = Asked(**json.loads(first))
    with contextlib.suppress(BrokenPipeError):
        for line in sys.stdin:
            for case, settings in json.loads(line):
                answers.write(to_text([case, asked.compute(settings)]) + "\n")
                answers.flush()


def cluster(asked: Asked, tasks: list[Task], client: Client) -> Generator[Done, None, None]:
    """Compute on the workers of a Dask scheduler."""
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
        raise TweezerError("scheduler: workers died too often; it can be resumed") from None
    except CancelledError:
        raise TweezerError("scheduler: is gone; it can be resumed") from None
    finally:
        executor.shutdown(wait=False)  # which cancels what is in flight


def _there(asked: Asked, ours: dict[str, str], task: Task) -> list[Done]:
    """Compute a task on a worker. Raises `TweezerError` if it has other versions."""
    for key, value in versions().items():
        if value != ours[key]:
            raise TweezerError(
                f"scheduler: worker {platform.node()} computes with another "
                f"{key.replace('_', ' ')}: {value}, not {ours[key]}"
            )
    return [(case, asked.compute(settings)) for case, settings in task]
