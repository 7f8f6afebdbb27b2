// pulseIn() with interrupts held: the interrupt of millis() does not delay its loop. millis() loses time.
#include "row.h"

void setup() {
  start();
}

void loop() {
  trigger();
  noInterrupts();
  unsigned long duration = pulseIn(ECHO_PIN, HIGH, 60000UL);
  interrupts();
  printRow(duration, 0);
}
