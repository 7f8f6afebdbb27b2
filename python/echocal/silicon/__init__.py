"""Generated functions on simulated silicon: what they cost there, and whether they give the proven bits.

Needs the compilers and simulators of the core in question, nothing of which comes with this package:
avr-gcc, libsimavr and a C compiler for an ATmega328P; arm-none-eabi-gcc or riscv64-unknown-elf-gcc and
QEMU for the others.
"""

from echocal.silicon.board import Generated
from echocal.silicon.cores import CORES, cores_of
from echocal.silicon.measurement import Measurement, measure, missing, output_hash

__all__ = ["CORES", "Generated", "Measurement", "cores_of", "measure", "missing", "output_hash"]
