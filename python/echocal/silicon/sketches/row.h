// What the sketches beside it share: trigger, thermometer, and the row that is printed.
// A TMP36 is at A0; -DLM35 or -DPOTENTIOMETER (0 to 50 degC) at compile time: another part.
#pragma once
#include <Arduino.h>

const unsigned char TRIGGER_PIN = 7;
const unsigned char ECHO_PIN = 8;  // ICP1, the capture pin of Timer1

inline void start() {
  pinMode(TRIGGER_PIN, OUTPUT);
  pinMode(ECHO_PIN, INPUT);
  Serial.begin(9600);
  Serial.println("echo_us,reading_m,temperature_C");
  delay(100);  // what is sent during the first echo would delay pulseIn()
}

inline void trigger() {
  digitalWrite(TRIGGER_PIN, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER_PIN, LOW);
}

inline float readTemperature() {
  float voltage = analogRead(A0) * 5.0 / 1024.0;
#if defined(POTENTIOMETER)
  return voltage * 50.0 / 5.0;
#elif defined(LM35)
  return voltage * 100.0;
#else
  return (voltage - 0.5) * 100.0;
#endif
}

// Echo time [us] with these digits, distance [m] at 343 m/s, temperature [degC].
inline void printRow(float duration, unsigned char digits) {
  Serial.print(duration, digits);
  Serial.print(",");
  Serial.print(duration * 0.000001 * 343.0 / 2, 3);
  Serial.print(",");
  Serial.println(readTemperature());
  delay(60);
}
