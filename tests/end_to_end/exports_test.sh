#!/usr/bin/env bash
# Grid maps as other programs read them: ROS maps in all three modes by PyYAML and Pillow, after map_server's rules; PNG;
# OctoMap's file by its header (readers_test reads it by OctoMap itself).
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

cat >serve.py <<'END'
import yaml
from PIL import Image

def serve(mode):
    """What map_server makes of the map: {(column, row): -1 or 0..100}, row 0 the lowest."""
    facts = yaml.safe_load(open(f"{mode}/map.yaml"))
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
END
exits 0 "$python" serve.py
says 'cells agree'
head -c 60 tree/map.bt | head -n 1 | grep -qx '# Octomap OcTree binary file' || die "no file of OctoMap"
