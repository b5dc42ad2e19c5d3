#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Python costs above C++: python_overhead.py [--calls N] [--json FILE]. Needs the package alcap.

Of `smoothest_field` on 5,120 triangles: the wall clock around the call, less the phases that C++ measured inside it. And
of a call that computes next to nothing: handing work to the second thread and back. The target is 1 ms for the first.
On a machine with other work the least and the quartile say what the call costs, and the median how busy the machine is:
whoever waits for a core waits in here.
"""
import argparse
import json
import time

import numpy as np

import alcap


def milliseconds(call, calls):
    """Of call(), less the phases of the run that it returns, if it is one."""
    times = []
    for _ in range(calls):
        start = time.perf_counter()
        result = call()
        stop = time.perf_counter()
        times.append(1e3 * (stop - start - (result.report['times']['total'] if hasattr(result, 'report') else 0.0)))
    times = np.array(times[calls // 10:])  # the first ones start threads
    return {'least': times.min(), 'quartile': np.percentile(times, 25), 'median': np.median(times), 'calls': len(times)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--calls', type=int, default=200)
    parser.add_argument('--json')
    arguments = parser.parse_args()
    surface, small = alcap.Surface(*alcap.shapes.icosphere(4)), alcap.shapes.tetrahedron()
    result = {'smoothest_field': milliseconds(lambda: alcap.smoothest_field(surface, n=4), arguments.calls),
              'hand_over': milliseconds(lambda: alcap.Surface(*small), 10 * arguments.calls)}
    for name, row in result.items():
        print(f'{name:<16} ms: least {row["least"]:.3f}, quartile {row["quartile"]:.3f}, median {row["median"]:.3f}')
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(result, file, indent=1)


if __name__ == '__main__':
    main()
