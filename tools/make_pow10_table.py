#!/usr/bin/env python3
"""Makes src/io/pow10_table.c: powers of ten as 128-bit numbers, for printing doubles (src/io/number_text.c).

Entry k holds ceil(10^k * 2^(127 - floor(log2(10^k)))), so its top bit is set. Exact integer arithmetic throughout.
Usage: tools/make_pow10_table.py > src/io/pow10_table.c
"""
from fractions import Fraction

FIRST, LAST = -292, 324


def entry(k):
    power = Fraction(10) ** k
    shift = 127
    floor_log2 = (10**k).bit_length() - 1 if k >= 0 else -(10**-k).bit_length()
    scaled = power * Fraction(2) ** (shift - floor_log2)
    value = -(-scaled.numerator // scaled.denominator)
    assert value.bit_length() == 128
    return value >> 64, value & (2**64 - 1)


print("/* Powers of ten from 10^%d to 10^%d, high and low halves.  Made by tools/make_pow10_table.py; not for editing by" % (FIRST, LAST))
print(" * hand. */")
print('#include "io/number_text.h"\n')
print("const uint64_t laves__pow10_table[%d][2] = {" % (LAST - FIRST + 1))
entries = ["{0x%016x, 0x%016x}" % entry(k) for k in range(FIRST, LAST + 1)]
for i in range(0, len(entries), 3):
    print("    " + ", ".join(entries[i : i + 3]) + ",")
print("};")
