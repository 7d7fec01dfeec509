# SPDX-License-Identifier: Apache-2.0
"""What Python adds to the library (docs/python.md): the time of an import, of 10,000 exact directions in one call, and
of a trace of about a second. The library's own time is what it states itself, `result.seconds`. Medians of five.

Usage: python bench/python_overhead.py [DEVICE [SCENE]]     with clray installed; SCENE: meshes/box_wing.obj
"""
import os
import statistics
import subprocess
import sys
import time

import numpy as np

import clray

TIMES = 5


def median(measure):
    return statistics.median(measure() for _ in range(TIMES))


def start_of(code):
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True)
    return time.perf_counter() - start


def against_library(trace):
    """Wall time of a trace and of its data set of pulses, over the library's own."""
    start = time.perf_counter()
    result = trace()
    result.delay.A.sum()
    wall = time.perf_counter() - start
    return wall, result.seconds["total"]


def spread(count):
    """Directions over the sphere: Fibonacci's lattice."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = 2.399963229728653 * np.arange(count)
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)


def main():
    device = clray.Device(sys.argv[1] if len(sys.argv) > 1 else "cpu")
    here = os.path.dirname(os.path.abspath(__file__))
    scene = clray.load(sys.argv[2] if len(sys.argv) > 2 else os.path.join(here, "..", "meshes", "box_wing.obj"))
    print(f"import clray          {median(lambda: start_of('import clray') - start_of('')):.3f} s")
    body = clray.Prepared(scene, device=device)
    suns = spread(10000)
    pairs = [against_library(lambda: body.trace(sources=suns)) for _ in range(TIMES)]
    wall, own = (statistics.median(column) for column in zip(*pairs))
    ratio = statistics.median(w / o for w, o in pairs)
    print(f"10,000 directions     {wall:.3f} s, in the library {own:.3f} s: {ratio:.3f} times")
    rays = 1 << 20
    while against_library(lambda: body.trace(method="points", rays=rays))[1] < 0.7:
        rays *= 2
    pairs = [against_library(lambda: body.trace(method="points", rays=rays)) for _ in range(TIMES)]
    wall, own = (statistics.median(column) for column in zip(*pairs))
    share = statistics.median(w / o - 1.0 for w, o in pairs)
    print(f"a trace of 2^{rays.bit_length() - 1} rays  {wall:.3f} s, in the library {own:.3f} s: {100 * share:+.2f} %")


if __name__ == "__main__":
    main()
