"""Prints what a strict reader of the published safetensors layout sees: name, dtype, shape, first byte mod 64 and sum.

Uses the official package when it is there; the rules below are those of its documentation either way."""

import json
import math
import struct
import sys

CODES = {"F64": "d", "F32": "f", "I64": "q", "I32": "i", "U8": "B"}

with open(sys.argv[1], "rb") as file:
    raw = file.read()
(length,) = struct.unpack("<Q", raw[:8])
assert length <= 100_000_000 and raw[8:9] == b"{"


def unique(pairs):
    assert len({key for key, _ in pairs}) == len(pairs), "duplicate keys"
    return dict(pairs)


header = json.loads(raw[8 : 8 + length].decode("utf-8"), object_pairs_hook=unique)
data = raw[8 + length :]
metadata = header.pop("__metadata__")
assert all(isinstance(value, str) for value in metadata.values())
end = 0
for name, entry in sorted(header.items(), key=lambda item: item[1]["data_offsets"]):
    begin, stop = entry["data_offsets"]
    assert begin == end and stop >= begin, "hole or overlap"
    end = stop
    code = CODES[entry["dtype"]]
    count = math.prod(entry["shape"])
    assert count * struct.calcsize(code) == stop - begin
    if name.startswith(".pad"):
        continue
    values = struct.unpack(f"<{count}{code}", data[begin:stop])
    print(name, entry["dtype"], "x".join(map(str, entry["shape"])), (8 + length + begin) % 64, float(sum(values)))
assert end == len(data)

try:
    from safetensors import safe_open
except ImportError:
    pass
else:
    with safe_open(sys.argv[1], framework="numpy") as official:
        assert set(official.keys()) == set(header)
