/**
 * @file Echocal_7f8cc3f8.h
 * @brief The library's own header. Its name is that of no other calibration.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "echocal_correction.h"
