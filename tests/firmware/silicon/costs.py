"""What was measured, held against the most that is allowed."""

from dataclasses import dataclass

from echocal import silicon
from echocal.firmware import Firmware


@dataclass(frozen=True)
class Cost:
    """What a call costs; ``steps`` are cycles on AVR and instructions elsewhere, its return included."""

    flash: int  # bytes, with what it takes from the compiler's library
    own: int  # bytes of the function and its tables alone
    ram: int  # bytes of variables of static storage duration
    stack: int  # bytes, return address included where there is one
    steps: int


def check(made: Firmware, core: str, options: str, ceilings: dict[str, Cost]) -> None:
    """Measure, and compare with the ceiling of this compiler's major version."""
    found = silicon.measure(made, core, options)
    assert found is not None, silicon.missing(core)
    assert (found.cycles, found.instructions) == (found.fewest_cycles, found.fewest_instructions)
    bytes_ = (found.flash_bytes, found.own_flash_bytes, found.ram_bytes, found.stack_bytes)
    cost = Cost(*bytes_, found.steps)
    most = ceilings[found.compiler.split()[-1].split(".")[0]]
    over = {field: value for field, value in vars(cost).items() if value > getattr(most, field)}
    assert not over, f"{cost} above {most}"
