"""The checksums of Cairn's files by numpy alone: of a chunk Fletcher's, as HDF5 has it, and in the trailer XXH3-128.

The latter is that of xxHash's specification (Y. Collet, doc/xxhash_spec.md) for inputs of more than 240 bytes, as all
HDF5 files are, without a seed.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
import numpy.typing as npt

_Words = npt.NDArray[np.uint64]

TRAILER_BYTES = 24
_MAGIC = b"CAIRNSUM"
_SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671fcb79e64eccc0e578825ad07dccff7221"
    "b8084674f743248ee03590e6813a264c3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364eac5ac8334d3ebc3c581a0fffa1363eb"
    "170ddd51b7f0da49d316552629d4689e2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e"
)
_P32 = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
_P64 = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5)
_BLOCK, _STRIPE, _FLETCHER_BLOCK = 1024, 64, 1 << 20  # bytes
_MASK = (1 << 64) - 1


def _secret(at: int) -> _Words:
    return np.frombuffer(_SECRET[at : at + _STRIPE], "<u8")


_KEYS = np.stack([_secret(8 * stripe) for stripe in range(_BLOCK // _STRIPE)])


def _products(data: bytes, keys: _Words) -> _Words:
    """What stripes add to the eight sums: [blocks, 8]."""
    stripes = np.frombuffer(data, "<u8").reshape(-1, *keys.shape)
    keyed = stripes ^ keys
    products = (keyed & np.uint64(0xFFFFFFFF)) * (keyed >> np.uint64(32))
    added: _Words = np.add.reduce(products + stripes[..., [1, 0, 3, 2, 5, 4, 7, 6]], axis=1)
    return added


def _merge(sums: _Words, at: int, start: int) -> int:
    keyed = [int(word) for word in sums ^ _secret(at)]
    total = start
    for i in range(0, 8, 2):
        product = keyed[i] * keyed[i + 1]
        total += (product & _MASK) ^ (product >> 64)
    total &= _MASK
    total = (total ^ total >> 37) * 0x165667919E3779F9 & _MASK
    return total ^ total >> 32


def xxh3_128(file: BinaryIO, size: int) -> bytes:
    """Of the first `size` bytes of a file, more than 240; big-endian, as xxHash's canonical form is."""
    sums = np.array([_P32[2], _P64[0], _P64[1], _P64[2], _P64[3], _P32[1], _P64[4], _P32[0]], np.uint64)
    scramble = _secret(len(_SECRET) - _STRIPE)
    blocks = (size - 1) // _BLOCK
    file.seek(0)
    for block in range(0, blocks, 4096):
        for added in _products(file.read(min(4096, blocks - block) * _BLOCK), _KEYS):
            sums = sums + added
            sums = (sums ^ sums >> np.uint64(47) ^ scramble) * np.uint64(_P32[0])
    stripes = (size - 1) % _BLOCK // _STRIPE
    if stripes:
        sums = sums + _products(file.read(stripes * _STRIPE), _KEYS[:stripes])[0]
    file.seek(size - _STRIPE)
    sums = sums + _products(file.read(_STRIPE), _secret(121)[np.newaxis])[0]
    low = _merge(sums, 11, size * _P64[0] & _MASK)
    high = _merge(sums, 117, ~(size * _P64[1]) & _MASK)
    return high.to_bytes(8, "big") + low.to_bytes(8, "big")


def trailer_is_right(file: BinaryIO) -> bool | None:
    """Whether the bytes of a file are those that were written; None: it has no trailer."""
    size = file.seek(0, 2) - TRAILER_BYTES
    if size <= 240:
        return None
    file.seek(size)
    trailer = file.read(TRAILER_BYTES)
    if not trailer.startswith(_MAGIC):
        return None
    return xxh3_128(file, size) == trailer[len(_MAGIC) :]


def fletcher32(data: bytes) -> int:
    """H5_checksum_fletcher32: of big-endian words of 16 bits, modulo 65535, where none but that of zeros is 0."""
    first = second = 0
    for at in range(0, len(data), _FLETCHER_BLOCK):
        block = data[at : at + _FLETCHER_BLOCK]
        words = np.frombuffer(block + b"\0" * (len(block) % 2), ">u2").astype(np.uint64)
        second += len(words) * first + int(words @ np.arange(len(words), 0, -1, dtype=np.uint64))
        first += int(words.sum())
    first, second = ((total % 65535 or 65535) if total > 0 else 0 for total in (first, second))
    return second << 16 | first
