/*
 * Runs generated firmware: `harness all` prints the hash over every accepted input, `harness each` answers
 * "echo_us temperature_code" lines (and the humidity code
 * where it is taken).
 */
#include <stdio.h>
#include <string.h>

#include "echocal_correction.h"
#include "hash.h"

/* The function's name and the types of its codes, where they are others than most. */
#ifndef DISTANCE
#define DISTANCE echocal_distance_um
#endif
#ifndef CODE
#define CODE int16_t
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

#ifdef ECHOCAL_HUMIDITY_CODE_FIRST
#define CALL(echo, code, damp) DISTANCE((ECHO)(echo), (CODE)(code), (DAMP)(damp))
#else
#define CALL(echo, code, damp) DISTANCE((ECHO)(echo), (CODE)(code))
#endif

static uint64_t hash_of_all(void)
{
    uint64_t all = 0;
    int32_t code;
    int32_t echo;
    for (code = ECHOCAL_TEMPERATURE_CODE_FIRST; code <= ECHOCAL_TEMPERATURE_CODE_LAST; code += WARM_STEP) {
#ifdef ECHOCAL_HUMIDITY_CODE_FIRST
        int32_t damp;
        for (damp = ECHOCAL_HUMIDITY_CODE_FIRST; damp <= ECHOCAL_HUMIDITY_CODE_LAST; damp += DAMP_STEP)
#endif
        {
            for (echo = ECHO_FIRST; echo <= ECHO_LAST; echo++) {
                all = append(all, (uint32_t)CALL(echo, code, damp));
            }
        }
    }
    return all;
}

int main(int count, char **arguments)
{
    unsigned int echo;
    int code;
#ifdef ECHOCAL_HUMIDITY_CODE_FIRST
    unsigned int damp;
    const int inputs = 3;
#define READ(echo, code) scanf("%u %d %u", &(echo), &(code), &damp)
#else
    const int inputs = 2;
#define READ(echo, code) scanf("%u %d", &(echo), &(code))
#endif
    if (count > 1 && strcmp(arguments[1], "all") == 0) {
        printf("%016llx\n", (unsigned long long)hash_of_all());
        return 0;
    }
    while (READ(echo, code) == inputs) {
        printf("%ld\n", (long)CALL(echo, code, damp));
    }
    return 0;
}
