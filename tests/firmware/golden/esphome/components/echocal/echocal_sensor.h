/**
 * @file echocal_sensor.h
 * @brief Corrected distance of an ultrasonic sensor, as a sensor of ESPHome.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#pragma once

#include "esphome/components/sensor/sensor.h"
#include "esphome/components/text_sensor/text_sensor.h"
#include "esphome/core/component.h"
#include "esphome/core/hal.h"

namespace esphome::echocal {

/// What the interrupt of the echo pin records.
struct EchoEdges {
  static void record(EchoEdges *edges);

  ISRInternalGPIOPin pin;
  volatile uint32_t rise_us{0};
  volatile uint32_t fall_us{0};
  volatile bool armed{false};
  volatile bool risen{false};
  volatile bool fallen{false};
};

class EchocalSensor : public sensor::Sensor, public PollingComponent {
 public:
  void set_trigger_pin(InternalGPIOPin *pin) { this->trigger_pin_ = pin; }
  void set_echo_pin(InternalGPIOPin *pin) { this->echo_pin_ = pin; }
  void set_temperature(sensor::Sensor *temperature) { this->temperature_ = temperature; }
  void set_timeout_us(uint32_t timeout_us) { this->timeout_us_ = timeout_us; }
  void set_status(text_sensor::TextSensor *status) { this->status_ = status; }

  void setup() override;
  void loop() override;
  void update() override;
  void dump_config() override;

 protected:
  void evaluate_(uint32_t echo_us);
  void publish_(const char *status, float distance = NAN);

  InternalGPIOPin *trigger_pin_{nullptr};
  InternalGPIOPin *echo_pin_{nullptr};
  sensor::Sensor *temperature_{nullptr};
  text_sensor::TextSensor *status_{nullptr};
  EchoEdges edges_;
  uint32_t timeout_us_{0};
  uint32_t triggered_us_{0};
  bool pending_{false};
};

}  // namespace esphome::echocal
