#!/usr/bin/env python3
"""Gives what `cairn export g2o` writes to GTSAM itself (https://github.com/borglab/gtsam).

    tests/end_to_end/gtsam_peer.py CAIRN GTSAM [--g2o G2O_BUILD]

CAIRN is the program; GTSAM the folder of GTSAMConfig.cmake, where GTSAM was built:

    cmake -S gtsam -B built -D CMAKE_BUILD_TYPE=Release -D GTSAM_BUILD_TESTS=OFF -D GTSAM_BUILD_EXAMPLES_ALWAYS=OFF -D GTSAM_BUILD_UNSTABLE=OFF \\
      -D GTSAM_WITH_TBB=OFF -D GTSAM_ENABLE_BOOST_SERIALIZATION=OFF -D GTSAM_USE_BOOST_FEATURES=OFF -D GTSAM_USE_SYSTEM_EIGEN=ON
    cmake --build built --target gtsam

It simulates logs, makes maps of them and exports these, and has GTSAM's readG2o read the graphs. It fails where GTSAM leaves out an edge that it is
said to know, where the error of its factors differs by more than a billionth from that of the file's numbers, reckoned here, or where its own
optimization moves the landmarks (of a local map the poses) by 0.2 m and more. GTSAM's error is half of chi2; the residual of its BetweenFactor is
x, y and heading in the measured pose's frame, as g2o's is, unless it was built with GTSAM_SLOW_BUT_CORRECT_EXPMAP, which takes their logarithm.
With --g2o it gives g2o_peer.py the same graphs.
"""
import argparse
import math
import pathlib
import subprocess
import sys
import tempfile

from g2o_peer import cost, read

PROJECT = """
cmake_minimum_required(VERSION 3.16)
project(peer CXX)
find_package(GTSAM REQUIRED)
add_executable(peer peer.cc)
target_link_libraries(peer gtsam)
"""

# peer GRAPH [FIXED…]: what GTSAM reads and its error; where vertices are fixed, that and all vertices after its optimization.
SOURCE = """
#include <gtsam/geometry/Pose2.h>
#include <gtsam/nonlinear/LevenbergMarquardtOptimizer.h>
#include <gtsam/slam/dataset.h>

#include <cstdio>
#include <cstdlib>

using namespace gtsam;

int main(int count, char** arguments) {
  auto [graph, values] = readG2o(arguments[1]);
  std::printf("%zu %zu %.17g\\n", values->size(), graph->size(), graph->error(*values));
  if (count == 2) return 0;
  // Of a FIX the reader knows nothing.
  for (int i = 2; i < count; ++i) {
    const Key key = std::strtoull(arguments[i], nullptr, 10);
    graph->addPrior(key, values->at<Pose2>(key), noiseModel::Isotropic::Sigma(3, 1e-6));
  }
  LevenbergMarquardtParams params;
  params.relativeErrorTol = 1e-10;
  const Values solved = LevenbergMarquardtOptimizer(*graph, *values, params).optimize();
  std::printf("%.17g\\n", graph->error(solved));
  for (const auto& [key, pose] : solved.extract<Pose2>())
    std::printf("%zu %.17g %.17g %.17g\\n", static_cast<std::size_t>(key), pose.x(), pose.y(), pose.theta());
}
"""

LOOP = ['simulate', 'loop', '--difficulty', 'base']
WORLDS = [('ranges, bearings and names', [*LOOP, '--robots', '2', '--seed', '3', '--sensor', 'range-bearing', '--identities'], 'landmark_map'),
          ('contacts', [*LOOP, '--robots', '4', '--seed', '1'], 'landmark_map'),
          ('a local map', ['simulate', 'office', '--minutes', '3', '--seed', '2'], 'local_map')]


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(' '.join(map(str, command)) + '\n' + done.stdout + done.stderr)
    return done.stdout


def expect(holds, otherwise):
    if not holds:
        raise SystemExit(otherwise)


def apart(ids, before, after):
    return math.sqrt(sum(math.dist(before[k][:2], after[k][:2])**2 for k in ids) / max(1, len(ids)))


def check(peer, name, graph):
    """What GTSAM reads of a graph against its numbers; returns chi2, and whether it reads all edges."""
    vertices, edges = read(graph)
    known = [edge for edge in edges if len(edge[2]) == 3 + 6]
    count, factors, error = run(peer, graph).split()
    ours, theirs = cost(vertices, known) / 2, float(error)
    print(f'{name}: GTSAM reads {count} of {len(vertices)} vertices, {factors} of {len(edges)} edges, with an error of {theirs:.9f}, '
          f'by the file {ours:.9f}', flush=True)
    expect(int(count) == len(vertices), 'GTSAM leaves vertices out')
    expect(len(known) > 0 and int(factors) == len(known), 'GTSAM reads another number of edges between poses')
    expect(abs(ours - theirs) <= 1e-9 * max(1.0, ours), 'GTSAM reads another cost')
    return 2 * ours, len(known) == len(edges)


def solve(peer, graph, landmarks):
    """GTSAM's own optimum; the vertices `landmarks` are such."""
    vertices, edges = read(graph)
    fixed = [line.split()[1] for line in graph.read_text().splitlines() if line.startswith('FIX')]
    error, *lines = run(peer, graph, *fixed).splitlines()[1:]
    moved = {int(line.split()[0]): [float(x) for x in line.split()[1:]] for line in lines}
    seen, poses = [k for k in moved if k in landmarks], [k for k in moved if k not in landmarks]
    ours, theirs = cost(moved, edges) / 2, float(error)
    print(f'  its optimum has {theirs:.6f}, by the file {ours:.6f}; it moves {len(seen)} landmarks by {apart(seen, vertices, moved):.4f} m, '
          f'{len(poses)} poses by {apart(poses, vertices, moved):.4f} m', flush=True)
    expect(len(seen) == len(landmarks), 'GTSAM solves for fewer landmarks')
    expect(abs(ours - theirs) <= 1e-6 * max(1.0, ours), 'the optimum has another cost')
    expect(apart(seen or poses, vertices, moved) < 0.2, 'GTSAM moves the map')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('cairn')
    parser.add_argument('gtsam')
    parser.add_argument('--g2o')
    options = parser.parse_args()
    cairn = pathlib.Path(options.cairn).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / 'CMakeLists.txt').write_text(PROJECT)
        (folder / 'peer.cc').write_text(SOURCE)
        run('cmake', '-S', folder, '-B', folder / 'build', '-D', f'GTSAM_DIR={pathlib.Path(options.gtsam).resolve()}')
        run('cmake', '--build', folder / 'build')
        peer = folder / 'build/peer'
        for number, (world, simulate, pipeline) in enumerate(WORLDS):
            log, result = folder / f'{number}.h5', folder / f'result {number}'
            run(cairn, *simulate, log)
            run(cairn, 'run', pipeline, log, '--out', result)
            points, poses = (folder / f'{number} {how}' / 'graph.g2o' for how in ('points', 'poses'))
            run(cairn, 'export', 'g2o', result, points.parent, '--log', log)
            run(cairn, 'export', 'g2o', result, poses.parent, '--log', log, '--landmarks-as-poses')
            vertices, edges = read(points)
            landmarks = {k for k, at in vertices.items() if len(at) == 2}
            _, whole = check(peer, world, points)
            expect(whole == (not landmarks), 'GTSAM knows EDGE_SE2_XY, or no EDGE_SE2')
            if landmarks:
                chi2, whole = check(peer, f'{world}, landmarks as poses', poses)
                expect(whole, 'of landmarks as poses GTSAM leaves edges out')
                expect(abs(chi2 - cost(vertices, edges)) <= 1e-9 * chi2, 'landmarks as poses have another cost')
            else:
                expect(poses.read_text() == points.read_text(), 'of no landmarks there are others as poses')
            solve(peer, poses, landmarks)
            for graph in (points, poses) if options.g2o else ():
                print('  g2o: ' + run(sys.executable, pathlib.Path(__file__).with_name('g2o_peer.py'), options.g2o, graph), end='', flush=True)


if __name__ == '__main__':
    main()
