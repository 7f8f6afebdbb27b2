"""A fleet: a verdict for every sensor of many logs, and how common each cause is among them."""

from echocal.fleet.run import diagnose_fleet

__all__ = ["diagnose_fleet"]
