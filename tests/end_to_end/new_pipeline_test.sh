#!/usr/bin/env bash
# CONTRIBUTING.md, "A new pipeline": a folder and one line. The example is built as it stands there, and every command knows it.
source "$(dirname "$0")/common.sh"

PATH=$CAIRN_BIN/../example/bin:$PATH
cairn simulate hallway --door-readings 3 --seed 1 hallway.h5 >/dev/null
exits 0 cairn pipelines
says '^driven_cells +log'
exits 0 cairn run driven_cells --help
says '^  p_occupied='
exits 0 cairn run driven_cells hallway.h5 --set cell_m=0.1 --workers 2 --out driven
says '^map +driven/driven_cells.h5$'
exits 0 cairn evaluate driven --truth hallway.h5
says '^cells.false_occupied +0 of [1-9][0-9]* free$'
exits 0 cairn inspect driven/driven_cells.h5
says '^  grid .* 0 occupied, [1-9][0-9]* free$'
exits 0 cairn report driven --log hallway.h5 --force
grep -q 'driven_cells' driven/report.html || die "the page does not name the stage"
refuses "allowed: a number from 0 to 0.5" cairn run driven_cells hallway.h5 --set p_occupied=0.7 --out no

# In a tree of its own: the folder, the line, and no more.
mkdir tree
(cd "$CAIRN_SOURCE" && git ls-files -z | xargs -0 cp --parents -t "$work/tree")
cd tree
cp -r docs/examples/new_pipeline pipelines/driven_cells
sed -i 's/^set(CAIRN_PIPELINES$/&\n  driven_cells/' pipelines/CMakeLists.txt
cmake --preset release -D BUILD_TESTING=OFF -D CAIRN_UNITY=OFF >configure.log 2>&1 || die "it is not configured: $(tail configure.log)"
# Its source and the registry: what they are linked with is as above.
cmake --build build/release --target pipelines/driven_cells/CMakeFiles/cairn_driven_cells.dir/driven_cells.cc.o \
  pipelines/CMakeFiles/cairn_pipelines.dir/registry.cc.o >build.log 2>&1 || die "it is not built: $(tail build.log)"
grep -q 'X(driven_cells)' build/release/generated/cairn_pipelines/pipelines/all.h || die "the registry does not have it"
