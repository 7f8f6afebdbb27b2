// Distance with an HC-SR04, temperature with a TMP36 at A0, as in the study.
// -DLM35 or -DPOTENTIOMETER at compile time: another part at A0. The potentiometer stands for 0 to 50 degC.
const int trigPin = 7;
const int echoPin = 8;
const int sensorPin = A0;
const float speedOfSound = 343.0;  // m/s, at 20 degC

void setup() {
  pinMode(trigPin, OUTPUT);
  pinMode(echoPin, INPUT);
  Serial.begin(9600);
  Serial.println("echo_us,reading_m,temperature_C");
  delay(100);
}

void loop() {
  digitalWrite(trigPin, LOW);
  delayMicroseconds(2);
  digitalWrite(trigPin, HIGH);
  delayMicroseconds(10);
  digitalWrite(trigPin, LOW);
  unsigned long duration = pulseIn(echoPin, HIGH);
  float distance = duration * 0.000001 * speedOfSound / 2;

  float temperature = readTemperature();

  Serial.print(duration);
  Serial.print(",");
  Serial.print(distance, 3);
  Serial.print(",");
  Serial.println(temperature);
  delay(60);
}

float readTemperature() {
  int value = analogRead(sensorPin);
  float voltage = value * 5.0 / 1024.0;
#if defined(POTENTIOMETER)
  return voltage * 50.0 / 5.0;
#elif defined(LM35)
  return voltage * 100.0;
#else
  return (voltage - 0.5) * 100.0;
#endif
}
