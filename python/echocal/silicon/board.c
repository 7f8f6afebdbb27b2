/*
 * On a bare Cortex-M or RISC-V core under QEMU: the hash over every accepted input, and the instructions of one call.
 * Speaks through semihosting; the hash is that of hash.h.
 */
#include "echocal_correction.h"
#ifdef SELFTEST
#include "echocal_selftest.h"
#endif

/* The function's name, its type and those of its codes, where they are others than most. */
#ifndef DISTANCE
#define DISTANCE echocal_distance_um
#endif
#ifndef CODE
#define CODE int16_t
#endif
#ifndef RESULT
#define RESULT int32_t
#endif
#ifndef DAMP
#define DAMP uint8_t
#endif
#ifndef ECHO
#define ECHO uint16_t
#endif
#ifdef ECHOCAL_ECHO_US_LAST
#define ECHO_FIRST ECHOCAL_ECHO_US_FIRST
#define ECHO_LAST ECHOCAL_ECHO_US_LAST
#else
#define ECHO_FIRST ECHOCAL_ECHO_CODE_FIRST
#define ECHO_LAST ECHOCAL_ECHO_CODE_LAST
#endif

/* Codes between those that the function tells apart. */
#ifdef ECHOCAL_TEMPERATURE_CODE_SHIFT
#define WARM_STEP (1 << ECHOCAL_TEMPERATURE_CODE_SHIFT)
#else
#define WARM_STEP 1
#endif
#ifdef ECHOCAL_HUMIDITY_CODE_SHIFT
#define DAMP_STEP (1 << ECHOCAL_HUMIDITY_CODE_SHIFT)
#else
#define DAMP_STEP 1
#endif

/* FURTHER is the type of a further input; then its codes are defined, too. */
#ifdef FURTHER
#define MORE_ARGUMENTS , FURTHER further
#define MORE_TYPES , FURTHER
#define MORE_GIVEN(further) , (FURTHER)(further)
#else
#define MORE_ARGUMENTS
#define MORE_TYPES
#define MORE_GIVEN(further)
#define FURTHER_FIRST 0
#define FURTHER_LAST 0
#define FURTHER_STEP 1
#endif

#ifdef ECHOCAL_HUMIDITY_CODE_FIRST
#define ARGUMENTS ECHO echo, CODE code, DAMP damp MORE_ARGUMENTS
#define TYPES ECHO, CODE, DAMP MORE_TYPES
#define GIVEN(echo, code, damp, further) (ECHO)(echo), (CODE)(code), (DAMP)(damp) MORE_GIVEN(further)
#else
#define ARGUMENTS ECHO echo, CODE code MORE_ARGUMENTS
#define TYPES ECHO, CODE MORE_TYPES
#define GIVEN(echo, code, damp, further) (ECHO)(echo), (CODE)(code) MORE_GIVEN(further)
#define ECHOCAL_HUMIDITY_CODE_FIRST 0
#define ECHOCAL_HUMIDITY_CODE_LAST 0
#endif

enum { WRITE0 = 0x04, EXIT = 0x18, CALLS = 2000, DEEP = 1024, PAINT = 0xA5 };
volatile int32_t sink;

/* One instruction, its return. */
static RESULT __attribute__((noinline)) nothing(ARGUMENTS)
{
    (void)code;
    return (RESULT)echo;
}

#ifdef __riscv
#define MOVE "mv"
static void host(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t a0 __asm__("a0") = operation;
    register uintptr_t a1 __asm__("a1") = argument;
    __asm__ volatile(".balign 16\n.option push\n.option norvc\n"
                     "slli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                     : "+r"(a0) : "r"(a1) : "memory");
}

static uint32_t now(void)
{
    uint32_t count;
    __asm__ volatile(".option push\n.option arch, +zicsr\ncsrr %0, minstret\n.option pop" : "=r"(count));
    return count;
}
#else
#define MOVE "mov"
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

#ifdef SELFTEST /* brings its own */
#elif !defined(COUNT)
#include "hash.h"

static uint64_t hash_of_all(void)
{
    uint64_t all = 0;
    int32_t code;
    int32_t echo;
    for (code = ECHOCAL_TEMPERATURE_CODE_FIRST; code <= ECHOCAL_TEMPERATURE_CODE_LAST; code += WARM_STEP) {
        int32_t damp;
        for (damp = ECHOCAL_HUMIDITY_CODE_FIRST; damp <= ECHOCAL_HUMIDITY_CODE_LAST; damp += DAMP_STEP) {
            int32_t further;
            for (further = FURTHER_FIRST; further <= FURTHER_LAST; further += FURTHER_STEP) {
                for (echo = ECHO_FIRST; echo <= ECHO_LAST; echo++) {
                    all = append(all, (uint32_t)DISTANCE(GIVEN(echo, code, damp, further)));
                }
            }
        }
    }
    return all;
}
#else

/* Ticks that CALLS calls take. */
static uint32_t time_of(
    RESULT (*volatile function)(TYPES), int32_t echo, int32_t code, int32_t damp, int32_t further)
{
    RESULT (*const called)(TYPES) = function;
    uint32_t start = now();
    int32_t count;
    (void)damp;
    (void)further;
    for (count = 0; count < CALLS; count++) {
        sink = called(GIVEN(echo, code, damp, further));
    }
    return now() - start;
}

/* Bytes below the caller's stack that a call writes to. */
static uint32_t __attribute__((noinline)) stack_of(RESULT (*volatile function)(TYPES))
{
    uintptr_t here, place;
    __asm__ volatile(MOVE " %0, sp" : "=r"(here));
    for (place = here - DEEP; place < here; place++) {
        *(volatile uint8_t *)place = PAINT;
    }
    sink = function(GIVEN(ECHO_LAST, ECHOCAL_TEMPERATURE_CODE_FIRST, ECHOCAL_HUMIDITY_CODE_LAST, FURTHER_LAST));
    for (place = here - DEEP; place < here && *(volatile uint8_t *)place == PAINT; place++) { }
    return (uint32_t)(here - place);
}

/* The stack of a call, the time of none, and the times of calls at the ends of each range and between. */
static void count_all(void)
{
    int32_t echo, code, damp, further;
    print(stack_of(DISTANCE));
    (void)time_of(nothing, 0, 0, 0, 0);
    print(time_of(nothing, 0, 0, 0, 0));
    for (echo = 0; echo < 4; echo++) {
        for (code = 0; code < 3; code++) {
            for (damp = 0; damp < 2; damp++) {
                for (further = 0; further < (FURTHER_LAST > FURTHER_FIRST ? 2 : 1); further++) {
                    print(time_of(DISTANCE,
                        ECHO_FIRST + (ECHO_LAST - ECHO_FIRST) / 3 * echo,
                        ECHOCAL_TEMPERATURE_CODE_FIRST
                            + (ECHOCAL_TEMPERATURE_CODE_LAST - ECHOCAL_TEMPERATURE_CODE_FIRST) / 2 * code,
                        damp ? ECHOCAL_HUMIDITY_CODE_LAST : ECHOCAL_HUMIDITY_CODE_FIRST,
                        further ? FURTHER_LAST : FURTHER_FIRST));
                }
            }
        }
    }
}
#endif

void board_main(void)
{
#ifdef __ARM_FP /* coprocessors 10 and 11, the floating-point unit, on */
    *(volatile uint32_t *)0xE000ED88 |= 0xFU << 20;
    __asm__ volatile("dsb\nisb");
#endif
#ifndef __riscv
    SYSTICK[1] = 0xFFFFFF;
    SYSTICK[2] = 0;
    SYSTICK[0] = 5;
#endif
#ifdef SELFTEST
    print(echocal_selftest());
#elif defined(COUNT)
    count_all();
#else
    const uint64_t hash = hash_of_all();
    print((uint32_t)(hash >> 32));
    print((uint32_t)hash);
#endif
    host(EXIT, 0x20026);
    for (;;) { }
}
