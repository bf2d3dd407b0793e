"""Connection to a Dask scheduler, for ensembles and sweeps."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from tweezer.values.errors import SceneError, TweezerError

if TYPE_CHECKING:
    from distributed import Client

#: Time to wait for a scheduler, for its first worker, and for all workers to stop, s
PATIENCE = 10
#: Pattern of the address of a scheduler
_ADDRESS = re.compile(r"inproc://.+|.+:[0-9]+")


@contextlib.contextmanager
def client_of(scheduler: str | Client) -> Iterator[Client]:
    """Provide the client of a Dask scheduler, given by its address or an existing client.

    Raises `SceneError` if the scheduler cannot be reached or has no workers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise TweezerError("scheduler: requires `pip install tweezer[cluster]`") from None
    if isinstance(scheduler, Client):
        if scheduler.status != "running":
            raise SceneError(f"scheduler: the client is {scheduler.status}")
        _await_workers(scheduler)
        yield scheduler
        return
    if not isinstance(scheduler, str) or not _ADDRESS.fullmatch(scheduler):
        raise SceneError(
            f"scheduler = {scheduler!r}: must be an address with a port, such as 127.0.0.1:8786, "
            "or a distributed.Client"
        )
    try:
        client = Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split())
        if scheduler.startswith("tls:"):
            reason += "; certificates are named in Dask's configuration, distributed.comm"
        raise SceneError(f"scheduler = {scheduler!r}: cannot be reached: {reason}") from None
    with client:
        _await_workers(client)
        yield client


def _await_workers(client: Client) -> None:
    """Wait for the first worker of a scheduler; raises `SceneError` after 10 s without one."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise SceneError("scheduler: has no workers") from None
