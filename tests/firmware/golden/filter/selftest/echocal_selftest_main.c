/**
 * @file echocal_selftest_main.c
 * @brief Program that runs the self-test. Exit status: 0 if it passed, 1 if it failed.
 *
 * Compile with -DECHOCAL_EVERY_INPUT to check all 4,019,204 accepted inputs.
 * Deviation from MISRA C:2012, required rule 21.6 (no stdio.h): a hosted program, on a PC, prints the result.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "echocal_selftest.h"

#if defined(__STDC_HOSTED__) && (__STDC_HOSTED__ == 1)
#include <stdio.h>
#define SAY(text) (void)puts(text)
#else
#define SAY(text) (void)(text)
#endif

int main(void)
{
    int failed = 0;
    if (echocal_selftest() != 0U) {
        failed = 1;
    }
#ifdef ECHOCAL_EVERY_INPUT
    if (echocal_output_hash() != ECHOCAL_OUTPUT_HASH) {
        failed = 1;
    }
#endif
    if (failed == 0) {
        SAY("echocal self-test: passed");
    } else {
        SAY("echocal self-test: FAILED");
    }
    return failed;
}
