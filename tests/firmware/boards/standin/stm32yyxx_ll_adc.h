/* The part of ST's header that the example needs: the converter's reference [mV], measured with the chip's own of 1.21 V. */
#define LL_ADC_RESOLUTION_12B 0
#define __LL_ADC_CALC_VREFANALOG_VOLTAGE(code, resolution) (1210L * 4095 / (code))
