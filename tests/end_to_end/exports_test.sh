#!/usr/bin/env bash
# Maps as other programs read them: ROS maps in all three modes by PyYAML and Pillow, after the rules of ROS's map_server and of
# nav2's; PNG; OctoMap's file by its header (readers_test reads it by OctoMap itself); trajectories in five formats, each against the others.
source "$(dirname "$0")/common.sh"
python=
for candidate in python3 /usr/bin/python3; do
  "$candidate" -c 'import yaml, PIL' 2>/dev/null && python=$candidate && break
done
[ -n "$python" ] || skip "there is no python3 with yaml and PIL (deploy/install.sh --dev)"

# A corridor of 3 m, 2 m wide, that a laser looks along.
awk 'BEGIN {
  for (i = 0; i <= 30; i++) {
    printf "FLASER 181"
    for (b = 0; b <= 180; b++) { s = sin((b - 90) * atan2(0, -1) / 180); if (s < 0) s = -s; r = s > 0.2 ? 1 / s : 30; printf " %.2f", r }
    printf " %g 0 0 %g 0 0 %g host %g\n", 0.1 * i, 0.1 * i, i, i
  }
}' >corridor.log
cairn import carmen corridor.log corridor.h5 --laser-max-range-m 10 2>/dev/null
cairn run evidence_map corridor.h5 --out grid --set cell_m=0.1 >/dev/null 2>&1
for mode in trinary scale raw; do exits 0 cairn export ros grid "$mode" --mode "$mode"; done
exits 0 cairn export png grid pictures
exits 0 cairn export mcap grid messages
exits 0 cairn inspect messages/map.mcap
says '^messages/map.mcap: an MCAP file, 2 topics'
says '^  /map foxglove.Grid: 1 messages'
exits 0 cairn export octomap grid tree
exits 0 cairn export octomap grid tree  # the same again
echo >>tree/map.bt
refuses "is there already" cairn export octomap grid tree
exits 0 cairn export octomap grid tree --force
refuses "mode.*\{trinary,scale,raw\}|trinary" cairn export ros grid other --mode grey

simulate drive.h5
for format in tum kitti euroc ply; do exits 0 cairn export $format drive.h5 $format; done
exits 0 cairn export geojson drive.h5 earth --latitude-deg 48.137 --longitude-deg 11.575
refuses "latitude-deg is required" cairn export geojson drive.h5 earth --force

cat >serve.py <<'END'
import glob
import json
import math

import yaml
from PIL import Image

def nav2(mode, grey, alpha, low, high):
    """As nav2's map_server has it, which looks at transparency first and rounds shades."""
    occupancy = 1 - grey / 255
    if mode == "raw":
        return grey if grey <= 100 else -1
    if mode == "scale" and alpha < 255:
        return -1
    if high < occupancy:
        return 100
    if occupancy < low:
        return 0
    return -1 if mode == "trinary" else round((occupancy - low) / (high - low) * 100)

def serve(mode):
    """What map_server makes of the map: {(column, row): -1 or 0..100}, row 0 the lowest."""
    facts = yaml.safe_load(open(f"{mode}/map.yaml"))
    # What nav2 does without: a map whose settings lack one of these is refused.
    assert {"image", "resolution", "origin", "free_thresh", "occupied_thresh", "negate"} < set(facts)
    assert len(facts["origin"]) == 3 and 0 <= facts["free_thresh"] < facts["occupied_thresh"] <= 1
    assert facts["mode"] == mode and facts["negate"] == 0 and abs(facts["resolution"] - 0.1) < 1e-12
    image = Image.open(f"{mode}/{facts['image']}")
    width, height = image.size
    cells = {}
    for x in range(width):
        for y in range(height):
            pixel = image.getpixel((x, y))
            grey, alpha = (pixel[0], pixel[3]) if isinstance(pixel, tuple) else (pixel, 255)
            occupancy = (255 - grey) / 255
            low, high = facts["free_thresh"], facts["occupied_thresh"]
            if mode == "raw":
                value = grey if grey <= 100 else -1
            elif occupancy > high:
                value = 100
            elif occupancy < low:
                value = 0
            elif mode == "trinary" or alpha < 255:
                value = -1
            else:
                value = int(1 + 98 * (occupancy - low) / (high - low))
            other = nav2(mode, grey, alpha, low, high)
            assert abs(other - value) <= (2 if mode == "scale" and 0 < value < 100 else 0), (mode, grey, value, other)
            cells[x, height - 1 - y] = value
    return facts, cells

maps = {mode: serve(mode) for mode in ("trinary", "scale", "raw")}
x0, y0, _ = maps["raw"][0]["origin"]
at = lambda mode, x, y: maps[mode][1][int((x - x0) // 0.1), int((y - y0) // 0.1)]
for mode in maps:
    wall = max(at(mode, 1.55, y) for y in (0.95, 1.05))
    assert wall > 90, (mode, "wall", wall)
    assert 0 <= at(mode, 1.55, 0.05) < 10, (mode, "free", at(mode, 1.55, 0.05))
    assert at(mode, 1.55, 1.35) == -1, (mode, "behind the wall", at(mode, 1.55, 1.35))
for cell, value in maps["trinary"][1].items():
    raw, scale = maps["raw"][1][cell], maps["scale"][1][cell]
    assert value != 100 or (raw >= 65 and scale == 100), cell
    assert value != 0 or (raw <= 20 and scale == 0), cell
    assert (raw == -1) == (scale == -1), cell
picture = Image.open("pictures/map.png")
assert picture.size == Image.open("raw/map.pgm").size
print(len(maps["raw"][1]), "cells agree")

def rows(pattern, between):
    (file,) = glob.glob(pattern)
    return [[float(word) for word in line.split(between)] for line in open(file) if not line.startswith("#")]

# One path in five formats, of which each is another's check.
tum, kitti, euroc = rows("tum/*.tum", " "), rows("kitti/*.kitti", " "), rows("euroc/*.csv", ",")
times = [row[0] for row in rows("kitti/*.times", " ")]
(file,) = glob.glob("ply/path_*.ply")
ply = open(file).read().split("end_header\n")[1].splitlines()
line = [f for f in json.load(open("earth/map.geojson"))["features"] if f["geometry"]["type"] == "LineString"][0]
assert len(tum) == len(kitti) == len(euroc) == len(times) == len(line["geometry"]["coordinates"]) > 1000
near = lambda a, b: all(math.isclose(x, y, abs_tol=1e-9) for x, y in zip(a, b, strict=True))
for i, (time, x, y, z, qx, qy, qz, qw) in enumerate(tum):
    r11, r12, r13, tx, r21, r22, r23, ty, r31, r32, r33, tz = kitti[i]
    assert near((tx, ty, tz, r33, times[i]), (x, y, 0, 1, time)) and z == qx == qy == r13 == r23 == r31 == r32 == 0
    assert near((r11, r12, r21, r22), (qw * qw - qz * qz, -2 * qw * qz, 2 * qw * qz, qw * qw - qz * qz))
    assert abs(euroc[i][0] - 1e9 * time) < 1 and near(euroc[i][1:8], (x, y, 0, qw, 0, 0, qz))
    assert near([float(word) for word in ply[i].split()][:4], (x, y, 0, time))
    east, north = line["geometry"]["coordinates"][i]
    assert abs((north - 48.137) * 111192.987 - y) < 0.05 and abs((east - 11.575) * 74427.561 - x) < 0.05, (i, x, y)
print(len(tum), "poses agree")
END
exits 0 "$python" serve.py
says 'cells agree'
says 'poses agree'
head -c 60 tree/map.bt | head -n 1 | grep -qx '# Octomap OcTree binary file' || die "no file of OctoMap"
