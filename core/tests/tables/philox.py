"""Writes philox.csv: words of numpy.random.Philox at the addresses of asperity's streams.

Run as `python philox.py > philox.csv` (made with numpy 2.4). numpy increments the low word of the
counter before its first block, hence counter = [0, index, purpose, 0].
"""

import numpy

CASES = [(0, 1, 0), (1, 1, 0), (1, 2, 0), (1, 1, 1), (2**64 - 1, 5, 2**64 - 1), (20080328, 3, 123456789)]

print("seed,purpose,index,draw,word,uniform")
for seed, purpose, index in CASES:
    def philox():
        words = [numpy.uint64(w) for w in (0, index, purpose, 0)]
        return numpy.random.Philox(key=numpy.array([seed, 0], dtype=numpy.uint64), counter=numpy.array(words))
    words = philox().random_raw(10)
    uniforms = numpy.random.Generator(philox()).random(10)
    for draw, (word, uniform) in enumerate(zip(words, uniforms)):
        print(f"{seed},{purpose},{index},{draw},{word},{float(uniform)!r}")
