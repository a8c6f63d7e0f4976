#!/usr/bin/env python3
"""error_reduction.py WINDOW_M: the error reduction in that window, in percent, of what `cairn evaluate --json` says of networks
(standard input). WINDOW_M 'none': without a window. Fails where it finds none."""
import json
import sys

window_m = None if sys.argv[1] == "none" else float(sys.argv[1])
found = [w["error_reduction"] for w in json.load(sys.stdin)["windows"] if w["window_m"] == window_m]
if len(found) != 1 or found[0] is None:
    sys.exit(f"error_reduction.py: no error reduction in a window of {sys.argv[1]} m")
print(f"{100 * found[0]:.1f}")
