# Big Wheel Bot's garden run with a camera: where each frame was taken, by dead reckoning, and the four ranges beside it.
# bigwheel_table.py FOLDER >TABLE.csv; docs/datasets.md says more.
import math, sys

METRES_A_TICK, SECONDS_A_ROW, FURTHEST_SONAR_M = 0.005, 0.3, 5.0

print("image,run,time_s,x_m,y_m,heading_rad,sonar front,sonar rear,infra-red left,infra-red right")
rows = [[int(value) for value in line.split(",")] for line in open(f"{sys.argv[1]}/Garden_small/Data.txt") if line.strip()]
x = y = 0.0
for k, (left, right, yaw, front, rear, infra_left, infra_right, *_) in enumerate(rows):
    heading = -math.radians(yaw)  # the gyro counts clockwise
    way = METRES_A_TICK * (left + right) / 2
    x, y = x + way * math.cos(heading), y + way * math.sin(heading)
    ranges = [min(front / 100, FURTHEST_SONAR_M), min(rear / 100, FURTHEST_SONAR_M), infra_left / 100, infra_right / 100]
    run = "first half" if k < len(rows) // 2 else "second half"
    print(f"{k:04d}.png,{run},{k * SECONDS_A_ROW:.1f},{x:.4f},{y:.4f},{heading:.5f}," + ",".join(f"{r:.2f}" for r in ranges))
