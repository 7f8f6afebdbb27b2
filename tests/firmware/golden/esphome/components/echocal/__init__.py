"""Corrected distance of an ultrasonic sensor: an external component of ESPHome. See README.md.

SPDX-License-Identifier: MIT OR Apache-2.0
"""
