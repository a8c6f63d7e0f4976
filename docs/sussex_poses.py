# Poses of the Sussex route's images: each track, smoothed over a second, at the images' times.
# sussex_poses.py FOLDER >poses.csv; docs/datasets.md says more.
import bisect, csv, gzip, sys

folder = sys.argv[1]
print("run,image,time_s,x_m,y_m")
for run, table, name in (("training", "training.csv", "snapshot"), ("infomax_binary", "testing.csv", "test_infomax_binary")):
    with gzip.open(f"{folder}/{run}/track.csv.gz", "rt") as f:
        track = [[float(v) for v in row] for row in csv.reader(f)]
    time_s = [row[0] / 1000 for row in track]
    smooth = []
    for k in range(len(track)):
        near = track[max(0, k - 15) : k + 16]
        smooth.append([sum(row[c] for row in near) / len(near) / 100 for c in (1, 2)])
    with open(f"{folder}/{run}/{table}") as f:
        for row in list(csv.reader(f, skipinitialspace=True))[1:]:
            t, number = float(row[0]), int(row[-1].split("_")[-1].split(".")[0])
            k = bisect.bisect(time_s, t)
            if not 0 < k < len(track):
                continue  # before or after the track
            share = (t - time_s[k - 1]) / (time_s[k] - time_s[k - 1])
            x, y = (a + share * (b - a) for a, b in zip(smooth[k - 1], smooth[k]))
            print(f"{run},{run}/{name}_{number:03d}.png,{t},{x:.4f},{y:.4f}")
