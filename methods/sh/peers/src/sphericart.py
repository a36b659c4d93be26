# Reads a count and directions, prints the basis functions at every 37th, then times all of them for every line read.
import sys
import time

import numpy
import sphericart

order, precision = int(sys.argv[1]), sys.argv[2]
count = int(sys.stdin.readline())
s = numpy.array([[float(x) for x in sys.stdin.readline().split()] for _ in range(count)], dtype=precision)
harmonics = sphericart.SphericalHarmonics(order - 1)
values = harmonics.compute(s)
for row in values[::37]:
    print(*(repr(float(x)) for x in row))
sys.stdout.flush()
for _ in sys.stdin:
    start = time.perf_counter()
    harmonics.compute(s)
    print(time.perf_counter() - start, flush=True)
