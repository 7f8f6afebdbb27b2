"""Values that the shell completes."""

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path


def bases(incomplete: str) -> list[str]:
    """Laws, and files that may hold a model."""
    folder, name = Path(incomplete).parent, Path(incomplete).name
    files = sorted(str(file) for file in folder.glob("*.json") if file.name.startswith(name))
    return [*laws(incomplete), *files]


def laws(incomplete: str) -> list[str]:
    """Laws of the speed of sound."""
    from echocal import _core

    return list(_beginning(incomplete, (law["id"] for law in _core.laws())))


def effects(incomplete: str) -> list[str]:
    """Effects, with the name of their first parameter."""
    from echocal.registry import effects as known

    written = (f"{effect.id}:{effect.parameters[0].name}=" for effect in known())
    return list(_beginning(incomplete, written))


def causes(incomplete: str) -> list[str]:
    """Ids of effects, noises and faults."""
    from echocal.diagnose.catalogue import causes as known

    return list(_beginning(incomplete, (cause.id for cause in known())))


def parameters(incomplete: str) -> list[str]:
    """Parameters that a calibration fits."""
    from echocal.registry import effects

    fitted = [f"{effect.id}.{parameter.name}" for effect in effects() for parameter in effect.parameters]
    return list(_beginning(incomplete, ["law.intercept", "law.slope", *fitted]))


def targets(incomplete: str) -> list[str]:
    """Cores that firmware is made for."""
    from echocal import _core

    return list(_beginning(incomplete, itertools.chain(*_core.firmware_targets())))


def _beginning(incomplete: str, words: Iterable[str]) -> Iterator[str]:
    return (word for word in words if word.startswith(incomplete))
