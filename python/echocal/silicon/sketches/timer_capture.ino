// Input capture of Timer1: interrupts do not matter.
#include "capture.h"
#include "row.h"

void setup() {
  start();
}

void loop() {
  trigger();
  printRow(captureEcho() * 0.5, 1);
}
