#!/usr/bin/env python3
"""Makes the values of the elementary functions that the tests of the engine compare with.

Run it, from anywhere, with a Python that has mpmath:

    pip install mpmath
    python tools/elementary_values.py

It uses nothing of Libration. It writes two files under crates/libration/tests:

* engine/elementary_values.csv: a function, its argument or arguments, and its value as a sum of two binary64 numbers,
  all of them as bits. The first part of the value is the correctly rounded one.
* numbers/wide_values.csv: a function, its argument or arguments, and its value with 310 decimal digits.
"""

import random
import struct
from fractions import Fraction
from pathlib import Path

from mpmath import mp, mpf

mp.prec = 1600
TESTS = Path(__file__).resolve().parent.parent / "crates" / "libration" / "tests"

# The functions of one argument, with the largest argument, and whether it may be negative.
FUNCTIONS = {
    "sin": (mp.sin, 1.6e6, True),
    "cos": (mp.cos, 1.6e6, True),
    "tan": (mp.tan, 1.6e6, True),
    "asin": (mp.asin, 1.0, True),
    "acos": (mp.acos, 1.0, True),
    "atan": (mp.atan, 1e300, True),
    "exp": (mp.exp, 709.0, True),
    "ln": (mp.log, 1.7e308, False),
    "sinh": (mp.sinh, 710.0, True),
    "cosh": (mp.cosh, 710.0, True),
    "tanh": (mp.tanh, 30.0, True),
}


def fraction(x):
    sign, man, exp, _ = mpf(x)._mpf_
    value = Fraction(int(man)) * Fraction(2) ** int(exp)
    return -value if sign else value

def bits(x):
    return f"{struct.unpack('>Q', struct.pack('>d', x))[0]:016x}"

def from_bits(n):
    return struct.unpack(">d", struct.pack(">Q", n))[0]

def single(x):
    return struct.unpack(">f", struct.pack(">f", x))[0]

def parts(value):
    """The nearest binary64 number, subnormal ones included, and the nearest one to the rest."""
    exact = fraction(value)
    high = exact.numerator / exact.denominator
    rest = exact - Fraction(high)
    return high, rest.numerator / rest.denominator

def between(rng, low, high):
    """A number that is about uniform in its exponent."""
    first, last = (struct.unpack(">Q", struct.pack(">d", x))[0] for x in (low, high))
    return from_bits(rng.randint(first, last))

def arguments(rng, largest, signed):
    """Binary64 numbers, every other one a binary32 number."""
    exponents = [between(rng, 1e-30, largest) for _ in range(12)]
    middle = [between(rng, 1e-3, min(largest, 50.0)) for _ in range(24)]
    uniform = [rng.uniform(0.0, min(largest, 3.0)) for _ in range(24)]
    # Both sides of the arguments where the formulas change: 1/2, tan(pi/8), sqrt(1/2), multiples of ln(2)/2 and pi/4.
    edges = [0.5, 0.41421356, 0.70710677, 0.34657359, 1.0397208, 0.78539816, 2.4142136, 1.4142135, 1.0 - 2.0**-20]
    edges = [x for c in edges for x in (c, c * (1.0 + 2.0**-22)) if x <= largest]
    tiny = [from_bits(1), from_bits(3 << 30), 1e-310, 2.0**-126, 2.0**-140]
    chosen = exponents + middle + uniform + edges + tiny
    chosen = [single(x) if i % 2 and 1e-30 < x < 1e30 else x for i, x in enumerate(chosen)]
    return [-x if signed and rng.random() < 0.5 else x for x in chosen]

def pairs(rng):
    quarter = lambda: rng.choice([-1.0, 1.0])
    for _ in range(40):
        yield between(rng, 1e-30, 1e30) * quarter(), between(rng, 1e-30, 1e30) * quarter()
    for i in range(80):
        y, x = rng.uniform(0.0, 1.0) * quarter(), rng.uniform(0.0, 1.0) * quarter()
        yield (single(y), single(x)) if i % 2 else (y, x)
    # Extreme vectors and tiny angles.
    yield from [(1e-300, 1e-320), (3e-310, -2e-310), (1e308, 1.5e308), (1e300, -1e-300), (-1e-200, 1e100), (5e-324, 5e-324)]

def main():
    rng = random.Random(20)
    lines, wide = ["function,x,other,high,low"], ["function,x,other,value"]
    for name, (function, largest, signed) in FUNCTIONS.items():
        for x in arguments(rng, largest, signed):
            high, low = parts(function(mpf(x)))
            lines.append(f"{name},{bits(x)},,{bits(high)},{bits(low)}")
        for x in (0.75, 2.0**-40, 0.3, 29.5) + ((-0.9,) if signed else (1.0 + 2.0**-50,)):
            if x <= largest:
                wide.append(f"{name},{bits(x)},,{mp.nstr(function(mpf(x)), 310)}")
    for y, x in pairs(rng):
        high, low = parts(mp.atan2(mpf(y), mpf(x)))
        lines.append(f"atan2,{bits(y)},{bits(x)},{bits(high)},{bits(low)}")
    for y, x in [(0.3, 0.7), (-2.5, 0.1), (1e-9, -4.0), (-7.0, -7.5)]:
        wide.append(f"atan2,{bits(y)},{bits(x)},{mp.nstr(mp.atan2(mpf(y), mpf(x)), 310)}")
    (TESTS / "engine" / "elementary_values.csv").write_text("\n".join(lines) + "\n")
    (TESTS / "numbers" / "wide_values.csv").write_text("\n".join(wide) + "\n")


if __name__ == "__main__":
    main()
