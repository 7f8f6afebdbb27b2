/**
 * @file echocal_sensor.cpp
 * @brief Measures the echo time by interrupts, without waiting, and converts it to a distance.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "echocal_sensor.h"

#include <cinttypes>
#include <cmath>

#include "echocal_correction.h"
#include "esphome/core/helpers.h"
#include "esphome/core/log.h"

namespace esphome::echocal {

static const char *const TAG = "echocal.sensor";

/// Length of the trigger pulse [us]: an HC-SR04 needs 10 us.
static constexpr uint32_t TRIGGER_US = 10;
/// The echo has ended when its pin has been low for this time [us]. On a long wire an edge can bounce.
static constexpr uint32_t SETTLED_US = 50;
/// Tick of the function's echo time [ps].
static constexpr uint64_t TICK_PS = 1000000ULL;

void IRAM_ATTR EchoEdges::record(EchoEdges *edges) {
  const uint32_t now = micros();
  if (!edges->armed) {
    return;
  }
  if (edges->pin.digital_read()) {
    if (!edges->risen) {
      edges->rise_us = now;
      edges->risen = true;
    }
    edges->fallen = false;
  } else if (edges->risen) {
    edges->fall_us = now;
    edges->fallen = true;
  }
}

void EchocalSensor::setup() {
  this->trigger_pin_->setup();
  this->trigger_pin_->digital_write(false);
  this->echo_pin_->setup();
  this->edges_.pin = this->echo_pin_->to_isr();
  this->echo_pin_->attach_interrupt(EchoEdges::record, &this->edges_, gpio::INTERRUPT_ANY_EDGE);
}

void EchocalSensor::update() {
  if (this->pending_) {
    return;
  }
  if (this->echo_pin_->digital_read()) {
    this->publish_("echo still high");
    return;
  }
  this->edges_.risen = false;
  this->edges_.fallen = false;
  this->trigger_pin_->digital_write(true);
  delayMicroseconds(TRIGGER_US);
  this->edges_.armed = true;  // edges during the trigger pulse come from a neighboring wire
  this->trigger_pin_->digital_write(false);
  this->triggered_us_ = micros();
  this->pending_ = true;
}

void EchocalSensor::loop() {
  if (!this->pending_) {
    return;
  }
  uint32_t rise, fall;
  bool ended;
  {
    InterruptLock lock;
    rise = this->edges_.rise_us;
    fall = this->edges_.fall_us;
    ended = this->edges_.fallen && micros() - fall > SETTLED_US;
    if (ended || micros() - this->triggered_us_ > this->timeout_us_ + SETTLED_US) {
      this->edges_.armed = false;
      this->pending_ = false;
    }
  }
  if (ended) {
    this->evaluate_(fall - rise);
  } else if (!this->pending_) {
    this->publish_("no echo");
  }
}

void EchocalSensor::evaluate_(uint32_t echo_us) {
  const uint64_t echo_code = (1000000ULL * echo_us + TICK_PS / 2) / TICK_PS;
  if (echo_code >= 35001) {  // so late a module ends its pulse without an echo
    this->publish_("no echo");
    return;
  }
  if (echo_code < ECHOCAL_ECHO_US_FIRST) {
    this->publish_("too near");
    return;
  }
  if (echo_code > ECHOCAL_ECHO_US_LAST) {
    this->publish_("too far");
    return;
  }
  const float temperature = this->temperature_->state;
  if (std::isnan(temperature)) {
    this->publish_("no temperature");
    return;
  }
  const float temperature_code = roundf((temperature - (0.0f)) / 0.5f);
  if (temperature_code < -40.0f || temperature_code > 120.0f) {
    this->publish_("temperature out of range");
    return;
  }

  const int32_t distance =
      echocal_distance_um((uint16_t) echo_code, (int16_t) temperature_code);
  this->publish_("ok", 1.0e-6f * (float) distance);
}

void EchocalSensor::publish_(const char *status, float distance) {
  ESP_LOGD(TAG, "'%s': %s", this->get_name().c_str(), status);
  if (this->status_ != nullptr) {
    this->status_->publish_state(status);
  }
  this->publish_state(distance);
}

void EchocalSensor::dump_config() {
  LOG_SENSOR("", "Echocal", this);
  LOG_PIN("  Trigger pin: ", this->trigger_pin_);
  LOG_PIN("  Echo pin: ", this->echo_pin_);
  LOG_TEXT_SENSOR("  ", "Status", this->status_);
  ESP_LOGCONFIG(TAG, "  Timeout: %" PRIu32 " us", this->timeout_us_);
  LOG_UPDATE_INTERVAL(this);
}

}  // namespace esphome::echocal
