// Input capture of Timer1: the hardware records each edge at ICP1 (pin 8), in ticks of 0.5 us.
#pragma once
#include <Arduino.h>

const unsigned long CAPTURE_TIME_OUT = 60000UL;  // us, for each edge

// Wait for an edge. Returns false after the time-out.
inline bool captureEdge(unsigned char rising, unsigned int &ticks) {
  const unsigned long since = micros();
  TCCR1B = rising | _BV(CS11);
  TIFR1 = _BV(ICF1);  // selecting the other edge can set the flag
  while ((TIFR1 & _BV(ICF1)) == 0) {
    if (micros() - since > CAPTURE_TIME_OUT) {
      return false;
    }
  }
  ticks = ICR1;
  return true;
}

// Length of the echo pulse in ticks of 0.5 us; 0 if there is none.
inline unsigned long captureEcho() {
  unsigned int rise, fall;
  TCCR1A = 0;
  if (!captureEdge(_BV(ICES1), rise)) {
    return 0;
  }
  const unsigned long begin = micros();
  if (!captureEdge(0, fall)) {
    return 0;
  }
  // The timer turns every 65536 ticks. micros() is coarser, and tells how often.
  const unsigned long about = 2 * (micros() - begin);
  unsigned long ticks = (unsigned int)(fall - rise);
  while (ticks + 32768UL < about) {
    ticks += 65536UL;
  }
  return ticks;
}
