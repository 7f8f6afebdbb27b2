/*
 * Runs generated firmware: `harness all` prints the hash over every accepted input, `harness each` answers
 * "echo_us temperature_code" lines. The hash is defined in firmware_gen/src/prove.rs.
 */
#include <stdio.h>
#include <string.h>

#include "echocal_correction.h"

static uint32_t fold(uint32_t hash, uint32_t word)
{
    return (hash ^ word) * UINT32_C(16777619);
}

static uint32_t hash_of_all(void)
{
    uint32_t all = UINT32_C(2166136261);
    int32_t code;
    int32_t echo;
    for (code = ECHOCAL_TEMPERATURE_CODE_FIRST; code <= ECHOCAL_TEMPERATURE_CODE_LAST; code++) {
        uint32_t row = UINT32_C(2166136261);
        for (echo = ECHOCAL_ECHO_US_FIRST; echo <= ECHOCAL_ECHO_US_LAST; echo++) {
            row = fold(row, (uint32_t)echocal_distance_um((uint16_t)echo, (int16_t)code));
        }
        all = fold(all, row);
    }
    return all;
}

int main(int count, char **arguments)
{
    unsigned int echo;
    int code;
    if (count > 1 && strcmp(arguments[1], "all") == 0) {
        printf("%08lx\n", (unsigned long)hash_of_all());
        return 0;
    }
    while (scanf("%u %d", &echo, &code) == 2) {
        printf("%ld\n", (long)echocal_distance_um((uint16_t)echo, (int16_t)code));
    }
    return 0;
}
