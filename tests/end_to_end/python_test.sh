#!/usr/bin/env bash
# The Python package: its own tests, against a simulated log and this build's program; then the example notebook.
source "$(dirname "$0")/common.sh"
python=
for candidate in /usr/bin/python3 python3; do  # Debian's own first: another one on the path seldom has Debian's packages
  "$candidate" -c 'import h5py, numpy' 2>/dev/null && python=$candidate && break
done
export PYTHONDONTWRITEBYTECODE=1 MPLBACKEND=agg
if [ -z "$python" ]; then
  if python3 -c 1 2>/dev/null; then  # whoever imports it is told what is missing
    exits 1 env PYTHONPATH="${PYTHONPATH:-}:$CAIRN_SOURCE/deploy/python" python3 -c 'import cairn'
    says '^ImportError: cairn needs h5py and numpy: apt install python3-h5py'
  fi
  skip "there is no python3 with h5py and numpy (deploy/install.sh --dev)"
fi
export PYTHONPATH=$CAIRN_SOURCE/deploy/python
exits 0 "$python" -m unittest cairn_test stop_test
says '^Ran [1-9][0-9]* tests'
tail -n 3 stderr
! command -v mypy >/dev/null || exits 0 mypy --strict --ignore-missing-imports --cache-dir "$work/mypy" "$PYTHONPATH/cairn"
if "$python" -c 'import matplotlib' 2>/dev/null; then
  exits 0 "$python" "$CAIRN_SOURCE/tests/end_to_end/run_notebook.py" "$CAIRN_SOURCE/docs/examples/first_map.ipynb"
  tail -n 1 stdout
else
  echo "not run: the notebook, for there is no matplotlib"
fi
