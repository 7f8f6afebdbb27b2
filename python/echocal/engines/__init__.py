"""Who runs tasks: this process, processes of this machine, or a cluster that is there already.

A task is plain data, and the same task makes the same files: so it may be run twice, anywhere. One engine is
one file and one line in `echocal.engines.names`.
"""

from echocal.engines.engine import Engine
from echocal.engines.names import open_engine

__all__ = ["Engine", "open_engine"]
