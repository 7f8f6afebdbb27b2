"""The study's question, why Tinkercad reads 7.7 mm short of the calculation.

Each suspect is one change of the experiment, on an emulated Arduino UNO. What it makes of the readings is
compared with Table 2 of the study.
"""
