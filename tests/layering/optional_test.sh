#!/usr/bin/env bash
# What depends on a package that a fresh machine lacks: every such source compiles with it and without it, with warnings as
# errors; every such test is skipped without it, or passes with less to look at, and does not fail.
#
# CAIRN_SOURCE: the sources; CAIRN_BUILD: a build of them with all tests. Exit code 77: no such package is installed here.
set -euo pipefail
cd "${CAIRN_SOURCE:?}"
scratch=${CAIRN_BUILD:?}/optional
mkdir -p "$scratch"

die() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}

# Packages that CMake may fail to find are hidden by CMake's own switch; what else may fail to find something would go unseen.
mapfile -t lists < <(git ls-files '*CMakeLists.txt' '*.cmake')
mapfile -t packages < <(grep -hoE 'find_package\([^ )]+ QUIET' "${lists[@]}" | sed 's/find_package(//; s/ QUIET//' | sort -u)
[ ${#packages[@]} -gt 0 ] || die "no optional package is looked for: this test looks at nothing"
! grep -nE '(find_(package|library|path|file)|pkg_(check_modules|search_module))\(' "${lists[@]}" |
  grep -vE 'REQUIRED|find_package\([^ )]+ QUIET' || die "neither REQUIRED nor 'find_package(NAME QUIET)': cannot be hidden"
! git grep -n '__has_include' -- '*.cc' '*.h' || die "__has_include cannot be hidden: let CMake find it"

hidden=()
for package in "${packages[@]}"; do hidden+=(-D "CMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
for tree in with without; do
  options=(-D CAIRN_WERROR=ON -D CAIRN_UNITY=OFF)
  [ $tree = with ] || options+=("${hidden[@]}")
  cmake --preset release -B "$scratch/$tree" "${options[@]}" >"$scratch/$tree.log" 2>&1 || die "$(cat "$scratch/$tree.log")"
done
found=()
for package in "${packages[@]}"; do
  if grep -qE "^${package}_DIR:PATH=/" "$scratch/with/CMakeCache.txt"; then
    found+=("$package")
  else
    printf '%s is not installed: compiled without it only\n' "$package"
  fi
done
if [ ${#found[@]} -eq 0 ]; then
  echo "SKIPPED: none of ${packages[*]} is installed"
  exit 77
fi

# The objects whose command is another one without those packages, or that are there one way only.
cat >"$scratch/differ.py" <<'END'
import json, sys

def commands(tree):
    every = (e["command"] for e in json.load(open(f"{tree}/compile_commands.json")))
    return {c.split(" -o ")[1].split()[0]: c.replace(tree, "BUILD") for c in every}

with_them, without = (commands(tree) for tree in sys.argv[1:3])
for output in sorted(with_them.keys() | without.keys()):
    if with_them.get(output) != without.get(output):
        for name, tree in ("with", with_them), ("without", without):
            if output in tree:
                print(name, output)
END
python3 "$scratch/differ.py" "$scratch/with" "$scratch/without" >"$scratch/differ"
[ -s "$scratch/differ" ] || die "no source depends on ${found[*]}: this test looks at nothing"
for tree in with without; do
  mapfile -t objects < <(sed -n "s/^$tree //p" "$scratch/differ")
  [ ${#objects[@]} -eq 0 ] || cmake --build "$scratch/$tree" --target "${objects[@]}" >"$scratch/$tree.log" 2>&1 ||
    die "does not compile $tree ${found[*]}: $(cat "$scratch/$tree.log")"
  for object in "${objects[@]}"; do printf '%s %s: compiles %s\n' "${found[*]}" "$tree" "$(basename "$object" .o)"; done
done

# Programs and Python's modules: out of sight, by a path on which all others are, and by modules that cannot be imported.
mapfile -t tests < <(git grep -lE "command -v|-c 'import" -- 'tests/end_to_end/*_test.sh' 'tests/faults/*_test.sh')
mapfile -t programs < <(git grep -hoE 'command -v [a-z0-9_-]+' -- "${tests[@]}" | cut -d' ' -f3 | sort -u)
[ ${#programs[@]} -gt 0 ] || die "no test looks for a program: this test looks at nothing"
! git grep -nE 'command -v [^a-z]' -- "${tests[@]}" || die "a program whose name is in a variable cannot be hidden"
rm -rf "$scratch/path" "$scratch/modules"
mkdir -p "$scratch/path" "$scratch/modules"
find /usr/sbin /usr/bin /sbin /bin -mindepth 1 -maxdepth 1 \( -type f -o -type l \) -print0 2>/dev/null |
  xargs -0 -r ln -sf -t "$scratch/path"
for program in "${programs[@]}"; do rm -f "$scratch/path/$program"; done
for module in h5py numpy matplotlib yaml PIL rosbag; do echo 'raise ImportError("hidden")' >"$scratch/modules/$module.py"; done
export PYTHONPATH=$scratch/modules PYTHONDONTWRITEBYTECODE=1 CAIRN_BIN=$CAIRN_BUILD/bin
for test in "${tests[@]}"; do
  # A test that needs them as a whole says when it skips; one that has more to look at where they are goes on without.
  expected=0
  ! grep -qE '(^|[ ;])skip "' "$test" || expected=77
  code=0
  PATH=$scratch/path bash "$test" >"$scratch/said" 2>&1 || code=$?
  [ $code -eq $expected ] ||
    die "$test: exit code $code, not $expected, without ${programs[*]}: $(cat "$scratch/said")"
  printf '%s: exit code %s without %s\n' "$test" "$code" "${programs[*]}"
done
"$CAIRN_BUILD/schema/store/store_test" --gtest_filter=FormatPage.ItsH5pyExampleRuns >"$scratch/said" 2>&1 || die "$(cat "$scratch/said")"
grep -q '\[  SKIPPED \]' "$scratch/said" || die "FormatPage.ItsH5pyExampleRuns runs without h5py: $(cat "$scratch/said")"
