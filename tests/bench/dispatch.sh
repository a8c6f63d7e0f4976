#!/usr/bin/env bash
# Empty tasks and round trips, ours beside dask.distributed in turns, the best of three each. Many workers: tests/swarm.
#
#   cmake --build --preset release --target dispatch_bench && tests/bench/dispatch.sh
#
# Needs Debian's python3-distributed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bench=build/release/tests/bench/dispatch_bench
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for _ in 1 2 3; do
  "$bench" --tasks 50000 --workers 2 2>/dev/null >>"$out/empty"
  "$bench" --tasks 5000 --chain --workers 2 2>/dev/null >>"$out/chain"
  /usr/bin/python3 tests/bench/dispatch_dask.py 2>/dev/null >>"$out/dask"
done
/usr/bin/python3 - "$out" <<'EOF'
import json, sys
def rows(name):
    return [json.loads(line) for line in open(f"{sys.argv[1]}/{name}")]
empty, chain, dask = rows("empty"), rows("chain"), rows("dask")
rate = max(row["tasks_per_s"] for row in empty)
whole = max(row["tasks"] / row["job_s"] for row in empty)
dask_rate = max(row["tasks_per_s"] for row in dask)
dask_whole = max(row["tasks"] / row["job_s"] for row in dask)
trip = min(row["median_gap_ms"] for row in chain)
dask_trip = min(row["median_round_trip_ms"] for row in dask)
print(f"empty tasks, 2 workers      {rate:9.0f} /s, dask {dask_rate:6.0f} /s: {rate / dask_rate:6.0f} times, {1e3 / rate:.3f} ms each")
print(f"  submitted to reduced      {whole:9.0f} /s, dask {dask_whole:6.0f} /s: {whole / dask_whole:6.0f} times")
print(f"round trip, one in flight   {trip:9.3f} ms, dask {dask_trip:6.2f} ms: {dask_trip / trip:6.0f} times")
EOF
