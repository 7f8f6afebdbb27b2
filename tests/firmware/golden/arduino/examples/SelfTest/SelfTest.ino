/*
 * Checks on the board that the function returns the proven outputs, and prints the result.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <Arduino.h>

#include <Echocal_7f8cc3f8.h>
#include <echocal_selftest.h>

void setup()
{
    Serial.begin(115200);
    const uint16_t wrong = echocal_selftest();
    if (wrong == 0) {
        Serial.println("echocal self-test: passed");
    } else {
        Serial.print("echocal self-test: FAILED at vector ");
        Serial.println(wrong);
    }
}

void loop()
{
}
