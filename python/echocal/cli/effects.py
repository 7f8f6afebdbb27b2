"""``echocal effects``: the registry."""

from rich.console import Console
from rich.table import Table

from echocal import _core


def command() -> None:
    """List the effects that echocal knows."""
    table = Table("id", "stage", "what it is")
    for facts in _core.effects():
        table.add_row(facts["id"], facts["stage"], facts["sentence"])
    Console().print(table)
