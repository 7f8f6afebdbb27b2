// The program of the study as its text describes it. A potentiometer at A0 stands for 0 to 50 degC. The target is at a
// fixed distance. The temperature acts in this program only: Tinkercad has no air.
// Each macro is one step of the program. A suspect replaces one of them (-D on the command line of the compiler).
#ifndef TEMPERATURE
#define TEMPERATURE(code) ((code) * 50.0 / 1023.0)
#endif
#ifndef SPEED
#define SPEED(celsius) (331.3 + 0.6 * (celsius))
#endif
#ifndef CENTIMETERS
#define CENTIMETERS(duration) ((duration) * 0.0343 / 2)
#endif
#ifndef READING
#define READING(centimeters) (centimeters)
#endif
#ifndef BEFORE
#define BEFORE
#endif
#ifndef BAUD
#define BAUD 9600
#endif

const int trigPin = 7;
const int echoPin = 8;

#ifndef DURATION
#define DURATION() undisturbed()
#endif

// Interrupts do not stop the loop of pulseIn().
long undisturbed() {
  noInterrupts();
  long duration = pulseIn(echoPin, HIGH);
  interrupts();
  return duration;
}

// The edges by micros(), as many programs do it; it can be late for the rise.
long polled() {
  while (digitalRead(echoPin) == LOW) {}
  unsigned long rise = micros();
  while (digitalRead(echoPin) == HIGH) {}
  return micros() - rise;
}

void setup() {
  pinMode(trigPin, OUTPUT);
  pinMode(echoPin, INPUT);
  Serial.begin(BAUD);
  Serial.println("echo_us,reading_m,temperature_C");
  delay(100);
}

void loop() {
  float celsius = TEMPERATURE((long)analogRead(A0));
  BEFORE
  digitalWrite(trigPin, LOW);
  delayMicroseconds(2);
  digitalWrite(trigPin, HIGH);
  delayMicroseconds(10);
  digitalWrite(trigPin, LOW);
  long duration = DURATION();
  float distance = CENTIMETERS(duration);
  float reading = distance * 343.0 / SPEED(celsius);
  Serial.print(duration);
  Serial.print(",");
  Serial.print(READING(reading) / 100.0, 3);
  Serial.print(",");
  Serial.println(celsius);
  delay(60);
}
