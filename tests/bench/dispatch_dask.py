# The peer of dispatch_bench: the same empty tasks under dask.distributed, two worker processes. Prints one JSON line.
# Needs Debian's python3-distributed.
import json
import time

from dask.distributed import Client, LocalCluster


def ran(_):
    return time.monotonic()


if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.gather(client.map(ran, range(100), pure=False))  # warm
        tasks = 2000
        begin = time.monotonic()
        times = sorted(client.gather(client.map(ran, range(tasks), pure=False)))
        job_s = time.monotonic() - begin
        trips = []
        for i in range(200):
            begin = time.monotonic()
            client.submit(ran, i, pure=False).result()
            trips.append(time.monotonic() - begin)
        print(json.dumps({
            "tasks": tasks, "workers": 2, "tasks_per_s": (tasks - 1) / (times[-1] - times[0]), "job_s": job_s,
            "median_round_trip_ms": 1e3 * sorted(trips)[len(trips) // 2]}))
