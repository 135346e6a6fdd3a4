#!/usr/bin/env python3
"""Writes golden_registers.txt: blocks of the controller protocol encoded by hand from its description
(docs/controller-protocol.md), with integers and the standard library only.

    python3 golden_registers.py > golden_registers.txt

Each line is a name and the block's registers in hex, as they go over the wire.
"""
import struct
import zlib


def words(data):
    return " ".join(f"{w:04x}" for w in struct.unpack(f">{len(data) // 2}H", data))


def quaternion(components, heat):
    """components: (w, x, y, z) as exact fractions of 2^29, the largest positive, given as None."""
    largest = components.index(None)
    rest = [c for c in components if c is not None]
    fields = [c & 0x3FFFFFFF for c in rest]
    fields[0] |= largest << 30
    if heat:
        fields[1] |= 1 << 30
    return struct.pack(">3I", *fields)


def waypoint(t_us, heat, a_um, a_q, b_um, b_q):
    return (struct.pack(">I", t_us) + struct.pack(">3i", *a_um) + quaternion(a_q, heat)
            + struct.pack(">3i", *b_um) + quaternion(b_q, heat))


def with_crc(data):
    return data + struct.pack(">I", zlib.crc32(data))


ONE = 1 << 29
# identity; half turn about x; (1/2, 1/2, 1/2, 1/2); (0.8, 0, -0.6, 0); (-0.36, 0.48, 0.8, 0) as rounded fixed point
IDENTITY = (None, 0, 0, 0)
HALF_TURN = (0, None, 0, 0)
DIAGONAL = (None, ONE // 2, ONE // 2, ONE // 2)
TILTED = (None, 0, -round(0.6 * ONE), 0)
LARGEST_Y = (-round(0.36 * ONE), round(0.48 * ONE), None, 0)

plain = waypoint(0, False, (0, 0, 0), IDENTITY, (1, -1, 1000), HALF_TURN)
hot = waypoint(1234567, True, (-2000000, 1999999, 3000000), DIAGONAL, (500, -500, 250), TILTED)
far = waypoint(0xFFFFFFFF, True, (2147483647, -2147483647, 0), LARGEST_Y, (0, 0, 0), IDENTITY)

print("waypoint_plain", words(plain))
print("waypoint_hot", words(hot))
print("waypoint_far", words(far))
print("window_empty", words(with_crc(struct.pack(">IIHH", 7, 42, 0, 0))))
print("window_one_last", words(with_crc(struct.pack(">IIHH", 0x01020304, 65536, 1, 1) + hot)))
print("window_three", words(with_crc(struct.pack(">IIHH", 5, 0, 3, 0) + plain + hot + far)))
print("command_open", words(with_crc(struct.pack(
    ">IHQII6I", 0xDEADBEEF, 1, 0x0123456789ABCDEF, 3, 0, 12345, 800000, 8000, 500, 190000, 1010))))
print("command_start", words(with_crc(struct.pack(">IHQII6I", 1, 2, 0x0123456789ABCDEF, 3, 9, 0, 0, 0, 0, 0, 0))))
status = struct.pack(">HHHHQIIIIHHIIIHQI", 2, 1, 9, 0x0002, 0x0123456789ABCDEF, 3, 9, 65544, 65536, 1016, 7, 77,
                     0xCBF43926, 0x11223344, 1999, 0x0000000100000002, 0x00010002)
print("status", words(status.ljust(80, b"\0")))
# A detail of the arms: arm 2, its tool, too near to the plinth, 7.6 mm.
print("status_arms", words((status + struct.pack(">HIHHi", 0, 0, 0, 2 << 12 | 7 << 8 | 7 << 4, 7600)).ljust(80, b"\0")))
print("arms", words(with_crc(struct.pack(">IQ12i", 9, 0x0123456789ABCDEF, 0, 1, -1, 1570796, -1570796, 3141593,
                                         16498, -1513489, 2037051, -228105, -496974, -92060))))
ident = struct.pack(">7HI4I6i6I", 0x4842, 1, 9, 26, 1024, 4, 1, 0xCAFED00D, 100000, 500000, 1000000, 2000000,
                    -2000000, -2000000, 0, 2000000, 2000000, 3000000, 5000, 500, 2000, 5000, 1000000, 800000)
print("ident", words(ident.ljust(128, b"\0")))
