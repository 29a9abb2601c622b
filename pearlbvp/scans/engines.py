"""Where the cases of a scan are computed: in this process, in others on this machine, or on a Dask cluster.

All are executors of ``concurrent.futures``' interface. A worker is kept to one thread of linear algebra.
"""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import AbstractContextManager, contextmanager
from typing import Any, TypeVar

from pearlbvp.errors import InputError
from pearlbvp.studies.parallel import serve

Answer = TypeVar("Answer")

Engine = Callable[[], AbstractContextManager[Executor]]
"""Makes an executor; again, where one is lost with a worker that died."""

PATIENCE = 10
"""Seconds that a scheduler has to answer."""


class TimedOut(Exception):
    """Work took longer than it may."""


class Here(Executor):
    """An executor that works in this process, when it is asked."""

    def submit(self, fn: Callable[..., Answer], /, *args: Any, **kwargs: Any) -> Future[Answer]:
        """Do it now."""
        future: Future[Answer] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


def local(workers: int) -> Engine:
    """So many processes on this machine; 1 is this process itself."""

    @contextmanager
    def engine() -> Iterator[Executor]:
        if workers == 1:
            yield Here()
            return
        from joblib.externals.loky import ProcessPoolExecutor  # a fifth of a second to import, and only this needs it

        threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
        pool = ProcessPoolExecutor(
            max_workers=workers, env=threads, timeout=300, initializer=serve, initargs=(os.getpid(),)
        )
        try:
            yield pool
        finally:
            pool.shutdown(wait=True, kill_workers=True)

    return engine


def dask(where: str | int) -> Engine:
    """A Dask cluster: that of a scheduler's address, or one of so many processes on this machine.

    Raises:
        InputError: Dask is not installed, or the scheduler does not answer.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        name = "workers" if isinstance(where, int) else "scheduler"
        raise InputError(name, "Dask is not installed", "install pearlbvp[dask]") from None

    @contextmanager
    def engine() -> Iterator[Executor]:
        if isinstance(where, int):
            try:
                cluster = LocalCluster(n_workers=where, threads_per_worker=1, dashboard_address=None)
            except (OSError, RuntimeError, TimeoutError) as error:
                why = " ".join(str(error).split())[:120] or type(error).__name__
                raise InputError(
                    "workers",
                    f"the cluster did not start ({why})",
                    'in a script call it under if __name__ == "__main__", or give a number of processes',
                ) from None
            with cluster, Client(cluster) as client:
                yield client.get_executor(pure=False)
            return
        try:
            client = Client(where, timeout=PATIENCE)
        except (OSError, ValueError, TimeoutError) as error:
            why = " ".join(str(error).split())[:120] or type(error).__name__
            raise InputError(
                "scheduler", f"{where} does not answer ({why})", "give the address of one that runs"
            ) from None
        with client:
            yield client.get_executor(pure=False)

    return engine


def given(executor: Executor) -> Engine:
    """Somebody's own executor, which stays open."""

    @contextmanager
    def engine() -> Iterator[Executor]:
        yield executor

    return engine


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def within(seconds: float | None, work: Callable[..., Answer], *arguments: Any) -> Answer:
    """What ``work`` answers, in so many seconds.

    It is interrupted between two steps of the interpreter, whatever thread it runs in: workers of clusters have several, so
    that signals would not do.

    Raises:
        TimedOut: it takes longer.
    """
    if seconds is None:
        return work(*arguments)
    thread, done = threading.get_ident(), threading.Event()

    def interrupt() -> None:
        if not done.wait(seconds):
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(TimedOut))

    clock = threading.Thread(target=interrupt, daemon=True)
    clock.start()
    try:
        return work(*arguments)
    finally:
        done.set()
        clock.join()
