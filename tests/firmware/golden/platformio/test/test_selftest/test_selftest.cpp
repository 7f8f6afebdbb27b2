/**
 * @file test_selftest.cpp
 * @brief Runs the self-test with PlatformIO's test runner: on the board, or on a PC (`pio test -e native`).
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifdef ARDUINO
#include <Arduino.h>
#endif
#include <unity.h>

#include <Echocal_7f8cc3f8.h>
#include <echocal_selftest.h>

void setUp() {}
void tearDown() {}

static void test_outputs_are_as_proven()
{
    TEST_ASSERT_EQUAL_UINT16(0, echocal_selftest());
}

static int run_tests()
{
    UNITY_BEGIN();
    RUN_TEST(test_outputs_are_as_proven);
    return UNITY_END();
}

#ifdef ARDUINO
void setup()
{
    delay(2000); /* [ms], until the test runner has opened the port */
    run_tests();
}

void loop() {}
#else
int main()
{
    return run_tests();
}
#endif
