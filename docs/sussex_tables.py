# The Sussex route's tracks, in metres and seconds, and the times of its images.
# sussex_tables.py FOLDER TRACK.csv TIMES.csv; docs/datasets.md says more.
import csv, gzip, sys

folder, track, times = sys.argv[1], open(sys.argv[2], "w"), open(sys.argv[3], "w")
print("run,time_s,x_m,y_m", file=track)
print("run,image,time_s", file=times)
for run, table, name in (("training", "training.csv", "snapshot"), ("infomax_binary", "testing.csv", "test_infomax_binary")):
    with gzip.open(f"{folder}/{run}/track.csv.gz", "rt") as f:
        for time_ms, x_cm, y_cm in csv.reader(f):
            print(f"{run},{float(time_ms) / 1000},{float(x_cm) / 100:.4f},{float(y_cm) / 100:.4f}", file=track)
    with open(f"{folder}/{run}/{table}") as f:
        for row in list(csv.reader(f, skipinitialspace=True))[1:]:
            number = int(row[-1].split("_")[-1].split(".")[0])
            print(f"{run},{run}/{name}_{number:03d}.png,{float(row[0])}", file=times)
