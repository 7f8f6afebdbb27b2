/**
 * @file test_selftest.cpp
 * @brief Runs the self-test on the board with PlatformIO's test runner.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <Arduino.h>
#include <unity.h>

#include <echocal_selftest.h>

void setUp() {}
void tearDown() {}

static void test_outputs_are_as_proven()
{
    TEST_ASSERT_EQUAL_UINT16(0, echocal_selftest());
}

void setup()
{
    delay(2000); /* [ms], until the test runner has opened the port */
    UNITY_BEGIN();
    RUN_TEST(test_outputs_are_as_proven);
    UNITY_END();
}

void loop() {}
