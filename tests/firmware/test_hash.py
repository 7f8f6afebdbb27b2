"""The hash of all outputs: no two wrong outputs pass the self-test."""

from pathlib import Path

import numpy as np
from toolchain import run

from echocal import Model, firmware
from echocal.firmware import Firmware
from echocal.silicon.avr import BASE, PRIME, joined

FAULTS = """
#include <stdio.h>
#include <stdint.h>

static uint32_t places[2], flips[2], place;
static int32_t faulty(uint16_t echo_us, int16_t temperature_code);
#define echocal_distance_um real
#include "echocal_correction.c"
#undef echocal_distance_um
#define echocal_distance_um faulty
#include "echocal_selftest.c"

/* The function, with some bits flipped in the outputs of two calls. */
static int32_t faulty(uint16_t echo_us, int16_t temperature_code)
{
    uint32_t output = (uint32_t)real(echo_us, temperature_code);
    output ^= place == places[0] ? flips[0] : 0U;
    output ^= place == places[1] ? flips[1] : 0U;
    place++;
    return (int32_t)output;
}

int main(void)
{
    while (scanf("%u %u %x %x", &places[0], &places[1], &flips[0], &flips[1]) == 4) {
        place = 0;
        puts(echocal_output_hash() == ECHOCAL_OUTPUT_HASH ? "passed" : "caught");
    }
    return 0;
}
"""


def small() -> Firmware:
    return firmware.generate(Model("cramer"), temperature=(5.0, -20.0, 60.0), echo=(1.0, 1_800, 200))


def slowly(outputs: np.ndarray) -> str:
    """The polynomial as its definition has it, one output after the other."""
    value = 0
    for output in outputs.ravel().tolist():
        value = (value * BASE + output + 2**31) % PRIME
    return f"{value:016x}"


def test_the_report_has_the_hash_of_its_definition() -> None:
    packed = small()
    axes = [packed.report["device"]["conditions"][0], packed.report["device"]["echo"]]
    codes = [np.arange(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1) for axis in axes]
    warm, echo = np.meshgrid(*codes, indexing="ij")
    assert packed.report["output_hash"] == slowly(packed.distance_um(echo, warm))


def test_no_two_faults_pass_the_selftest(tmp_path: Path, random: np.random.Generator) -> None:
    """In drawn outputs: bit 31 of both, which passed; the same bit of both; any two bits; any two errors."""
    packed = small()
    packed.save(tmp_path)
    (tmp_path / "faults.c").write_text(FAULTS)
    places = (f"-I{tmp_path}", f"-I{tmp_path / 'selftest'}")
    run("gcc", "-std=c99", "-O2", *places, tmp_path / "faults.c", "-o", tmp_path / "faults")
    outputs = int(packed.report["inputs_checked"])
    same = 1 << random.integers(0, 32, 250)
    flips = [
        np.full((250, 2), 1 << 31),
        np.stack([same, same], axis=1),
        1 << random.integers(0, 32, (250, 2)),
        random.integers(1, 1 << 32, (250, 2)),
    ]
    lines = []
    for pair in np.concatenate(flips):
        first, second = random.choice(outputs, 2, replace=False)
        lines.append(f"{first} {second} {pair[0]:x} {pair[1]:x}")
    said = run(tmp_path / "faults", text="\n".join([*lines, f"{outputs} {outputs} 1 1"])).split()
    assert said[-1] == "passed", "without a fault"
    assert said[:-1] == ["caught"] * 1000


def test_every_pair_of_flipped_bits_is_caught() -> None:
    """A pair k outputs apart passes if BASE^k is plus or minus a power of two: for no k that a function has.

    Of a Mersenne prime 2^61 - 1 these are a group of 122 numbers. BASE^k is one of them only if the order of
    BASE^122 divides k.
    """
    powers = {pow(2, k, PRIME) for k in range(200)}
    assert len(powers | {PRIME - power for power in powers}) == 122
    order = (PRIME - 1) // 122
    primes = [2, 3, 5, 7, 11, 13, 31, 41, 61, 151, 331, 1321]
    rest = order
    for prime in primes:
        while rest % prime == 0:
            rest //= prime
    assert rest == 1, "these are the primes of the order"
    found = pow(BASE, 122, PRIME)
    assert pow(found, order, PRIME) == 1
    assert all(pow(found, order // prime, PRIME) != 1 for prime in primes if order % prime == 0)
    assert order > 65_536 * 65_536 * 256, "more outputs than three codes can have"


def test_parts_of_a_sequence_join(random: np.random.Generator) -> None:
    outputs = random.integers(-(2**31), 2**31, 600)
    parts = [int(slowly(part), 16) for part in outputs.reshape(-1, 25)]
    assert f"{joined(parts, 25):016x}" == slowly(outputs)
