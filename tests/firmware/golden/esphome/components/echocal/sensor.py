"""The sensor platform `echocal`: its options, and the C++ that they become.

SPDX-License-Identifier: MIT OR Apache-2.0
"""

from esphome import pins
import esphome.codegen as cg
from esphome.components import sensor, text_sensor
import esphome.config_validation as cv
from esphome.const import (
    CONF_ECHO_PIN,
    CONF_STATUS,
    CONF_TEMPERATURE,
    CONF_TIMEOUT,
    CONF_TRIGGER_PIN,
    DEVICE_CLASS_DISTANCE,
    ENTITY_CATEGORY_DIAGNOSTIC,
    ICON_ARROW_EXPAND_VERTICAL,
    STATE_CLASS_MEASUREMENT,
    UNIT_METER,
)

AUTO_LOAD = ["text_sensor"]

LONGEST_ECHO_US = 25072

EchocalSensor = cg.esphome_ns.namespace("echocal").class_(
    "EchocalSensor", sensor.Sensor, cg.PollingComponent
)

CONFIG_SCHEMA = (
    sensor.sensor_schema(
        EchocalSensor,
        unit_of_measurement=UNIT_METER,
        icon=ICON_ARROW_EXPAND_VERTICAL,
        accuracy_decimals=4,
        device_class=DEVICE_CLASS_DISTANCE,
        state_class=STATE_CLASS_MEASUREMENT,
    )
    .extend(
        {
            cv.Required(CONF_TRIGGER_PIN): pins.internal_gpio_output_pin_schema,
            cv.Required(CONF_ECHO_PIN): pins.internal_gpio_input_pin_schema,
            cv.Required(CONF_TEMPERATURE): cv.use_id(sensor.Sensor),
            # With a shorter time far echoes that the function accepts would be lost.
            cv.Optional(CONF_TIMEOUT, default="50073us"): cv.All(
                cv.positive_time_period_microseconds,
                cv.Range(min=cv.TimePeriod(microseconds=LONGEST_ECHO_US)),
            ),
            cv.Optional(CONF_STATUS): text_sensor.text_sensor_schema(
                entity_category=ENTITY_CATEGORY_DIAGNOSTIC
            ),
        }
    )
    .extend(cv.polling_component_schema("60s"))
)


async def to_code(config):
    var = await sensor.new_sensor(config)
    await cg.register_component(var, config)
    cg.add(var.set_trigger_pin(await cg.gpio_pin_expression(config[CONF_TRIGGER_PIN])))
    cg.add(var.set_echo_pin(await cg.gpio_pin_expression(config[CONF_ECHO_PIN])))
    cg.add(var.set_temperature(await cg.get_variable(config[CONF_TEMPERATURE])))
    cg.add(var.set_timeout_us(config[CONF_TIMEOUT]))
    if status := config.get(CONF_STATUS):
        cg.add(var.set_status(await text_sensor.new_text_sensor(status)))
