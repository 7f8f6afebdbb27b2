// pulseInLong(): micros() at both edges, in steps of 4 us.
#include "row.h"

void setup() {
  start();
}

void loop() {
  trigger();
  printRow(pulseInLong(ECHO_PIN, HIGH, 60000UL), 0);
}
