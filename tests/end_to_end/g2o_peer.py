#!/usr/bin/env python3
"""Gives what `cairn export g2o` writes to g2o itself (https://github.com/RainerKuemmerle/g2o, built with its applications).

    tests/end_to_end/g2o_peer.py G2O_BUILD GRAPH.g2o

G2O_BUILD is its build folder, with bin/ and lib/. It fails where g2o leaves a line out, where the cost that g2o reads differs from that of the
file's numbers, reckoned here, by more than a millionth, or where g2o's own optimization moves the landmarks by 0.2 m and more.
"""
import argparse
import math
import os
import pathlib
import re
import subprocess
import tempfile


def read(path):
    vertices, edges = {}, []
    for line in pathlib.Path(path).read_text().splitlines():
        tag, *rest = line.split()
        if tag.startswith('VERTEX'):
            vertices[int(rest[0])] = [float(x) for x in rest[1:]]
        elif tag.startswith('EDGE'):
            edges.append((int(rest[0]), int(rest[1]), [float(x) for x in rest[2:]]))
    return vertices, edges


def turned(x, y, angle):
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def cost(vertices, edges):
    """Sum of e' W e, as EdgeSE2 and EdgeSE2PointXY have e."""
    total = 0.0
    for a, b, numbers in edges:
        begin, end = vertices[a], vertices[b]
        n = 3 if len(end) == 3 else 2
        measured, upper = numbers[:n], numbers[n:]
        error = list(turned(end[0] - begin[0], end[1] - begin[1], -begin[2]))
        error = [error[0] - measured[0], error[1] - measured[1]]
        if n == 3:
            error = list(turned(*error, -measured[2]))
            error.append(math.remainder(end[2] - begin[2] - measured[2], 2 * math.pi))
        k = 0
        for i in range(n):
            for j in range(i, n):
                total += (1 if i == j else 2) * upper[k] * error[i] * error[j]
                k += 1
    return total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build')
    parser.add_argument('graph')
    options = parser.parse_args()
    build = pathlib.Path(options.build)
    vertices, edges = read(options.graph)
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, 'out.g2o')
        libraries = str(build / 'lib')
        run = subprocess.run([build / 'bin' / 'g2o', '-i', '20', '-solver', 'lm_var', '-typeslib', next((build / 'lib').glob('libg2o_types_slam2d.so')),
                              '-solverlib', next((build / 'lib').glob('libg2o_solver_eigen.so')), '-o', out, options.graph],
                             capture_output=True, text=True, env={**os.environ, 'LD_LIBRARY_PATH': libraries, 'LC_ALL': 'C'}, check=False)
        if run.returncode != 0:
            raise SystemExit(run.stdout + run.stderr)
        theirs = float(re.search(r'Initial chi2 = ([0-9.e+-]+)', run.stderr + run.stdout)[1])
        moved, kept = read(out)
    ours = cost(vertices, edges)
    landmarks = [(v, moved[k]) for k, v in vertices.items() if len(v) == 2]
    apart = math.sqrt(sum((a[0] - b[0])**2 + (a[1] - b[1])**2 for a, b in landmarks) / max(1, len(landmarks)))
    print(f'{len(vertices)} vertices, {len(edges)} edges; chi2 {ours:.6f} by the file, {theirs:.6f} as g2o reads it, '
          f'{cost(moved, edges):.6f} after its optimization, which moves {len(landmarks)} landmarks by {apart:.4f} m')
    if len(moved) != len(vertices) or len(kept) != len(edges):
        raise SystemExit(f'g2o keeps {len(moved)} vertices and {len(kept)} edges')
    if abs(ours - theirs) > 1e-6 * max(1.0, ours):
        raise SystemExit('g2o reads another cost')
    if apart >= 0.2:
        raise SystemExit('g2o moves the landmarks')


if __name__ == '__main__':
    main()
