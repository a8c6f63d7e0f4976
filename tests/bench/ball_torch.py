#!/usr/bin/env python3
"""BaLL's sum beside PyTorch (Debian's python3-torch): the same factorised form, float32, one thread, autograd.

  ball_torch.py build/release/tests/bench/ball_rate

PyTorch multiplies matrices by whatever libblas.so.3 is: it wants OpenBLAS (libopenblas0-pthread); with Debian's
reference BLAS it is several times slower, and the ratios mean nothing. OpenBLAS has threads of its own, which
torch.set_num_threads leaves alone: it is told by OPENBLAS_NUM_THREADS, or a busy second core doubles its time.

The matrices of e*B and B are given to PyTorch ready made; what is timed is E and its gradient by G. ball_rate makes
them anew each time. Each row runs ball_rate, PyTorch, ball_rate, and takes the lesser of the two.
"""
import os
import re
import subprocess
import sys
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before it is loaded
try:
    import torch
except ModuleNotFoundError:
    sys.exit("ball_torch.py: there is no PyTorch for this Python; apt-get install python3-torch")

SAMPLES, LENGTH_M = 2424, 89.0


def torch_ms(networks, window_m, belief_matrix):
    """The quickest turn. `belief_matrix`: whether Z is a product with B even where B is one everywhere."""
    torch.manual_seed(7)
    x = LENGTH_M * (torch.arange(SAMPLES) + torch.rand(SAMPLES)) / SAMPLES
    y = 0.2 * torch.randn(SAMPLES)
    distance = torch.hypot(x[:, None] - x, y[:, None] - y)
    belief = (distance <= window_m if window_m else torch.ones_like(distance)).float()
    weighted = distance * belief
    g = torch.rand(SAMPLES, networks)
    features = torch.ones(SAMPLES, 1)
    for i in range(networks):
        features = torch.cat([features * (1 - g[:, i:i + 1]), features * g[:, i:i + 1]], 1)
    features.requires_grad_()
    least, began = float("inf"), time.perf_counter()
    while time.perf_counter() - began < 2.0:
        features.grad = None
        start = time.perf_counter()
        z = belief @ features if belief_matrix else features.sum(0)
        error = (features * (weighted @ features) / z).sum() / SAMPLES
        error.backward()
        least = min(least, time.perf_counter() - start)
    return 1e3 * least


def cairn_ms(program, networks, window_m):
    text = subprocess.run([program, str(SAMPLES), str(networks), str(window_m), str(LENGTH_M)],
                          check=True, capture_output=True, text=True).stdout
    return float(re.search(r"([0-9.]+) ms", text).group(1))


def blas():
    """The libraries that PyTorch multiplies by, as this process has loaded them."""
    with open("/proc/self/maps") as maps:
        return sorted({line.split()[-1] for line in maps if re.search(r"blas[^/]*\.so", line)})


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: ball_torch.py BALL_RATE")
    torch.set_num_threads(1)
    torch.ones(2, 2) @ torch.ones(2, 2)
    print(f"PyTorch {torch.__version__}, one thread, K = {SAMPLES}, {', '.join(blas())}")
    if not any("openblas" in library for library in blas()):
        print("without OpenBLAS PyTorch is several times slower than it could be: do not report these ratios")
    for networks in (4, 8):
        for window_m in (0, 2):
            before = cairn_ms(sys.argv[1], networks, window_m)
            other = torch_ms(networks, window_m, True)
            ours = min(before, cairn_ms(sys.argv[1], networks, window_m))
            where = f"+-{window_m} m" if window_m else "global"
            print(f"n = {networks}, {where}: PyTorch {other:.2f} ms, Cairn {ours:.3f} ms, {other / ours:.1f} times faster",
                  flush=True)
        other = torch_ms(networks, 0, False)
        print(f"n = {networks}, global, with Z as one sum in PyTorch too: {other:.2f} ms", flush=True)


main()
