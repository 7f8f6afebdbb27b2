"""Who runs tasks: this process, processes of this machine, or a cluster that is there already.

A task is plain data, and the same task makes the same files: so it may be run twice, anywhere. One engine is
one file and one line in `echocal.engines`.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext

from echocal.engines.engine import Engine, Here
from echocal.engines.processes import Processes
from echocal.errors import UsageError

__all__ = ["ENGINES", "Engine", "is_elsewhere", "open_engine"]


def _local(rest: str, workers: int) -> AbstractContextManager[Engine]:
    return nullcontext(Here() if workers == 1 else Processes(workers))


def _dask(rest: str, workers: int) -> AbstractContextManager[Engine]:
    from echocal.engines.dask import scheduler

    return scheduler(rest)


def _dask_local(rest: str, workers: int) -> AbstractContextManager[Engine]:
    from echocal.engines.dask import local_cluster

    return local_cluster(workers)


def _ray_local(rest: str, workers: int) -> AbstractContextManager[Engine]:
    from echocal.engines.ray import local_cluster

    return local_cluster(workers)


ENGINES: dict[str, Callable[[str, int], AbstractContextManager[Engine]]] = {
    "local": _local,
    "dask-local": _dask_local,
    "dask://HOST:PORT": _dask,
    "ray-local": _ray_local,
}
"""What opens an engine, by the form of its name."""


def is_elsewhere(engine: str | Engine) -> bool:
    """Whether the workers of an engine may be on other machines, with working folders of their own."""
    return not isinstance(engine, str) or "://" in engine


@contextmanager
def open_engine(name: str | Engine, workers: int = 1) -> Iterator[Engine]:
    """Open an engine for the time of a block.

    Raises `UsageError` if there is no such engine, its library is not installed, or nobody answers at its
    address.

    Parameters
    ----------
    name : str or Engine
        ``local``, ``dask-local``, ``dask://HOST:PORT``, ...; an engine that is open stays so.
    workers : int
        Processes of an engine of this machine. A cluster has its own.
    """
    if not isinstance(name, str):
        yield name
        return
    scheme, colon, rest = name.partition("://")
    for form, opening in ENGINES.items():
        if form == name or (colon and rest and form.startswith(f"{scheme}://")):
            with opening(rest, workers) as engine:
                yield engine
            return
    raise UsageError(f"no engine '{name}'; engines: {', '.join(ENGINES)}")
