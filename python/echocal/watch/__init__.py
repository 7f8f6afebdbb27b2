"""Watch sensors: correct rows as they come, and tell when a sensor changes (docs/watch.md)."""

from echocal._verb import callable_as
from echocal.watch.engine import watch
from echocal.watch.events import Event
from echocal.watch.fleet import Fleet
from echocal.watch.reference import Reference, models_of
from echocal.watch.settings import WatchSettings
from echocal.watch.state import State

__all__ = ["Event", "Fleet", "Reference", "State", "WatchSettings", "models_of", "watch"]

callable_as(__name__)
