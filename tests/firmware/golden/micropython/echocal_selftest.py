"""Check on the board that echocal_correction returns the proven outputs. Run it with ``import echocal_selftest``.

It reads echocal_golden.csv line by line. Copy that file to the board, too.

SPDX-License-Identifier: MIT OR Apache-2.0
"""

from echocal_correction import distance_um, status


def selftest(path="echocal_golden.csv"):
    """Return the number of correct lines, and a list of the wrong lines."""
    right, wrong = 0, []
    with open(path) as golden:
        golden.readline()
        for line in golden:
            *codes, distance, reason = [int(word) for word in line.split(",")]
            if distance_um(*codes) == distance and status(*codes) == reason:
                right += 1
            else:
                wrong.append(line.strip())
    return right, wrong


RIGHT, WRONG = selftest()
print("echocal self-test:", "FAILED at " + WRONG[0] if WRONG or not RIGHT else "passed, %d lines" % RIGHT)
