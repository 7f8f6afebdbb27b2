/*
 * On a bare Cortex-M or RISC-V core under QEMU: the hash over every accepted input, and the instructions of one call.
 * Speaks through semihosting; the hash is defined in firmware_gen/src/prove/mod.rs.
 */
#include "echocal_correction.h"

#ifdef ECHOCAL_HUMIDITY_CODE_FIRST
#define ARGUMENTS uint16_t echo, int16_t code, uint8_t damp
#define TYPES uint16_t, int16_t, uint8_t
#define GIVEN(echo, code, damp) (uint16_t)(echo), (int16_t)(code), (uint8_t)(damp)
#else
#define ARGUMENTS uint16_t echo, int16_t code
#define TYPES uint16_t, int16_t
#define GIVEN(echo, code, damp) (uint16_t)(echo), (int16_t)(code)
#define ECHOCAL_HUMIDITY_CODE_FIRST 0
#define ECHOCAL_HUMIDITY_CODE_LAST 0
#endif

enum { WRITE0 = 0x04, EXIT = 0x18, CALLS = 100000 };
static const uint32_t SEED = UINT32_C(2166136261);
volatile int32_t sink;

/* One instruction, its return. */
static int32_t __attribute__((noinline)) nothing(ARGUMENTS)
{
    (void)code;
    return echo;
}

#ifdef __riscv
static void host(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t a0 __asm__("a0") = operation;
    register uintptr_t a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n.option norvc\n.balign 16\n"
                     "slli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                     : "+r"(a0) : "r"(a1) : "memory");
}

static uint32_t now(void)
{
    uint32_t count;
    __asm__ volatile("csrr %0, minstret" : "=r"(count));
    return count;
}
#else
#define SYSTICK ((volatile uint32_t *)0xE000E010)
static void host(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

/* Counts down at the board's clock; with -icount shift=0 one instruction takes 1 ns. */
static uint32_t now(void)
{
    return (0xFFFFFFU - SYSTICK[2]) & 0xFFFFFFU;
}
#endif

static void print(uint32_t number)
{
    char text[11];
    int place;
    for (place = 0; place < 8; place++) {
        text[place] = "0123456789abcdef"[number >> (28 - 4 * place) & 15U];
    }
    text[8] = '\n';
    text[9] = 0;
    host(WRITE0, (uintptr_t)text);
}

#ifndef COUNT
static uint32_t fold(uint32_t hash, uint32_t word)
{
    return (hash ^ word) * UINT32_C(16777619);
}

static uint32_t hash_of_all(void)
{
    uint32_t all = SEED;
    int32_t code;
    int32_t echo;
    for (code = ECHOCAL_TEMPERATURE_CODE_FIRST; code <= ECHOCAL_TEMPERATURE_CODE_LAST; code++) {
        int32_t damp;
        for (damp = ECHOCAL_HUMIDITY_CODE_FIRST; damp <= ECHOCAL_HUMIDITY_CODE_LAST; damp++) {
            uint32_t row = SEED;
            for (echo = ECHOCAL_ECHO_US_FIRST; echo <= ECHOCAL_ECHO_US_LAST; echo++) {
                row = fold(row, (uint32_t)echocal_distance_um(GIVEN(echo, code, damp)));
            }
            all = fold(all, row);
        }
    }
    return all;
}
#else

/* Ticks that CALLS calls take. */
static uint32_t time_of(int32_t (*volatile function)(TYPES))
{
    int32_t (*const called)(TYPES) = function;
    uint32_t start = now();
    int32_t count;
    for (count = 0; count < CALLS; count++) {
        sink = called(GIVEN(12345, ECHOCAL_TEMPERATURE_CODE_LAST, ECHOCAL_HUMIDITY_CODE_LAST));
    }
    return now() - start;
}
#endif

void board_main(void)
{
#ifndef __riscv
    SYSTICK[1] = 0xFFFFFF;
    SYSTICK[2] = 0;
    SYSTICK[0] = 5;
#endif
#ifdef COUNT
    (void)time_of(nothing);
    print(time_of(nothing));
    print(time_of(echocal_distance_um));
#else
    print(hash_of_all());
#endif
    host(EXIT, 0x20026);
    for (;;) { }
}
