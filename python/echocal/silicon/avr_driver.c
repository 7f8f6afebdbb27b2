/*
 * Calls a generated function in a simulated ATmega328P, one call for each accepted input:
 *
 *     avr_driver FIRMWARE.elf ECHO_FIRST ECHO_LAST FIRST LAST STEP [FIRST LAST STEP [FIRST LAST STEP]]
 *
 * After the echo stand the codes of the temperature and of up to two other arguments. Prints, for every STEP-th code of all
 * these in order, its hash over all echo codes; then the fewest and the
 * most cycles of a call, `call` and `ret` included, and the bytes of stack, return address included. The simulator is
 * GPL-3: it is used where it is installed, and no part of what is shipped.
 */
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hash.h"

/* Registers of the arguments; each takes two, of 32 bits four, from r25 down. A result of 16 bits is in r24 and r25. */
#ifndef ECHO
#define ECHO 24
#define TEMPERATURE 22
#define HUMIDITY 20
#define FURTHER 18
#endif
#ifndef SHORT
#define SHORT 0
#endif

enum { LOW = 0x5D, HIGH = 0x5E, STACK_TOP = 0x8FF, RESULT = 22 };
enum { SLEEP = 1, ENOUGH = 1000000 }; /* cycles */

static avr_t *avr;
static avr_cycle_count_t fewest = ~(avr_cycle_count_t)0, most;
static unsigned lowest = STACK_TOP;

static unsigned pointer(void)
{
    return avr->data[LOW] | (unsigned)avr->data[HIGH] << 8;
}

static void put(int where, unsigned value)
{
    avr->data[where] = (uint8_t)value;
    avr->data[where + 1] = (uint8_t)(value >> 8);
}

/* An argument of up to 32 bits: what it does not use belongs to the one before it, which is put after it. */
static void give(int where, uint32_t value)
{
    put(where, value & 0xFFFFU);
    put(where + 2, value >> 16);
}

/* What the function returns, as it left it in r22 .. r25. */
static uint32_t call(unsigned echo, const int *codes, int watch_stack)
{
    const avr_cycle_count_t before = avr->cycle;
    put(LOW, STACK_TOP);
    give(FURTHER, (uint32_t)codes[2]);
    give(HUMIDITY, (uint32_t)codes[1]);
    give(TEMPERATURE, (uint32_t)codes[0]);
    give(ECHO, echo);
    avr->pc = 0;
    avr->state = cpu_Running;
    while (avr->state == cpu_Running) {
        /* Whole calls at once, unless the stack is watched after each instruction. */
        avr->run_cycle_count = watch_stack ? 0 : ENOUGH;
        avr->pc = avr_run_one(avr);
        if (watch_stack && pointer() < lowest) {
            lowest = pointer();
        }
    }
    const avr_cycle_count_t spent = avr->cycle - before - SLEEP;
    fewest = spent < fewest ? spent : fewest;
    most = spent > most ? spent : most;
    const uint8_t *result = avr->data + RESULT;
    if (SHORT) {
        return (uint32_t)(int32_t)(int16_t)(result[2] | (uint16_t)result[3] << 8);
    }
    return result[0] | (uint32_t)result[1] << 8 | (uint32_t)result[2] << 16 | (uint32_t)result[3] << 24;
}

/* The hash over one row of echo codes. */
static uint64_t row(unsigned first, unsigned last, const int *codes, int watch_stack)
{
    uint64_t hash = 0;
    for (unsigned echo = first; echo <= last; echo++) {
        hash = append(hash, call(echo, codes, watch_stack));
    }
    return hash;
}

int main(int count, char **words)
{
    elf_firmware_t firmware = {0};
    if (count < 7 || elf_read_firmware(words[1], &firmware) != 0 || !(avr = avr_make_mcu_by_name("atmega328p"))) {
        return 1;
    }
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    avr->log = LOG_NONE;
    /* What start-up code does: tables that are not in program memory are copied to the start of RAM. */
    memcpy(avr->data + 0x100, avr->flash + firmware.flashsize - firmware.datasize, firmware.datasize);
    const unsigned echo_first = (unsigned)atoi(words[2]), echo_last = (unsigned)atoi(words[3]);
    int first[3] = {0}, last[3] = {0}, step[3] = {1, 1, 1}, codes[3];
    for (int place = 0; place < 3 && 6 + 3 * place < count; place++) {
        first[place] = atoi(words[4 + 3 * place]);
        last[place] = atoi(words[5 + 3 * place]);
        step[place] = atoi(words[6 + 3 * place]);
    }
    int watch_stack = 1; /* in the first row */
    for (codes[0] = first[0]; codes[0] <= last[0]; codes[0] += step[0]) {
        for (codes[1] = first[1]; codes[1] <= last[1]; codes[1] += step[1]) {
            for (codes[2] = first[2]; codes[2] <= last[2]; codes[2] += step[2]) {
                printf("%016llx\n", (unsigned long long)row(echo_first, echo_last, codes, watch_stack));
                watch_stack = 0;
            }
        }
    }
    printf("%llu %llu %u\n", (unsigned long long)fewest, (unsigned long long)most, STACK_TOP - lowest);
    return 0;
}
