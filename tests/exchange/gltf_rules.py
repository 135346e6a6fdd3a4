"""Rules of the glTF 2.0 specification (Khronos, section 3) that a mesh scene can break; each problem is a line of text."""
import base64
import functools
import math
import struct
import zlib

COMPONENTS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
PRIMITIVE_OF = {0: 1, 1: 2, 4: 3}  # points, lines, triangles: indices come in groups of


def single(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


@functools.cache
def decoded(uri):
    return base64.b64decode(uri.split(",", 1)[1], validate=True)


class Asset:
    def __init__(self, gltf):
        self.gltf = gltf
        self.problems = []
        self.buffers = [decoded(b["uri"]) for b in gltf.get("buffers", [])]

    def claim(self, condition, problem):
        if not condition:
            self.problems.append(problem)
        return condition

    def item(self, kind, index):
        items = self.gltf.get(kind, [])
        self.claim(isinstance(index, int) and 0 <= index < len(items), f"{kind}[{index}] does not exist")
        return items[index]

    def values(self, index):
        """An accessor's rows, checked against its view and its buffer (3.6)."""
        accessor = self.item("accessors", index)
        view = self.item("bufferViews", accessor["bufferView"])
        form, width = COMPONENTS[accessor["componentType"]], WIDTH[accessor["type"]]
        size = struct.calcsize(form)
        start, offset = view.get("byteOffset", 0), accessor.get("byteOffset", 0)
        stride = view.get("byteStride", size * width)
        name = f"accessors[{index}]"
        self.claim(accessor["count"] >= 1, f"{name}: no elements")
        self.claim(offset % size == 0 and (start + offset) % size == 0, f"{name}: not aligned to {size} bytes")
        self.claim(stride % size == 0 and ("byteStride" not in view or 4 <= stride <= 252), f"{name}: stride {stride}")
        end = offset + stride * (accessor["count"] - 1) + size * width
        if not self.claim(end <= view["byteLength"], f"{name}: longer than its view"):
            return []
        data = self.buffers[view["buffer"]]
        at = start + offset
        last = at + stride * (accessor["count"] - 1)
        if stride == size * width:
            rows = list(struct.iter_unpack(f"<{width}{form}", data[at:last + stride]))
        else:
            rows = [struct.unpack_from(f"<{width}{form}", data, k) for k in range(at, last + 1, stride)]
        self.limits(name, accessor, rows)
        return rows

    def limits(self, name, accessor, rows):
        for key, pick in (("min", min), ("max", max)):
            if key not in accessor:
                continue
            actual = [pick(column) for column in zip(*rows)]
            stated = [single(x) if accessor["componentType"] == 5126 else x for x in accessor[key]]
            self.claim(actual == stated, f"{name}: {key} is {actual}, not {stated}")


def check_buffers(asset):
    for k, (buffer, data) in enumerate(zip(asset.gltf.get("buffers", []), asset.buffers)):
        asset.claim(len(data) >= buffer["byteLength"] >= 1, f"buffers[{k}]: shorter than it says")
    for k, view in enumerate(asset.gltf.get("bufferViews", [])):
        buffer = asset.item("buffers", view["buffer"])
        end = view.get("byteOffset", 0) + view["byteLength"]
        asset.claim(view["byteLength"] >= 1 and end <= buffer["byteLength"], f"bufferViews[{k}]: outside its buffer")


def check_primitive(asset, name, primitive):
    attributes = primitive["attributes"]
    if not asset.claim("POSITION" in attributes, f"{name}: no POSITION"):
        return
    position = asset.item("accessors", attributes["POSITION"])
    asset.claim((position["type"], position["componentType"]) == ("VEC3", 5126), f"{name}: POSITION is not float VEC3")
    asset.claim("min" in position and "max" in position, f"{name}: POSITION without min and max")
    points = asset.values(attributes["POSITION"])
    asset.claim(all(math.isfinite(x) for p in points for x in p), f"{name}: a place that is not a number")
    for attribute, index in attributes.items():
        asset.claim(asset.item("accessors", index)["count"] == len(points), f"{name}: {attribute} of another count")
    if "NORMAL" in attributes:
        normals = asset.values(attributes["NORMAL"])
        asset.claim(all(abs(math.hypot(*n) - 1) < 1e-3 for n in normals), f"{name}: a normal that is not unit")
    if "TEXCOORD_0" in attributes:
        places = asset.values(attributes["TEXCOORD_0"])
        asset.claim(all(-1e-6 <= x <= 1 + 1e-6 for p in places for x in p), f"{name}: a texture place outside 0 to 1")
    mode = primitive.get("mode", 4)
    if not asset.claim(mode in PRIMITIVE_OF, f"{name}: mode {mode}"):
        return
    if "indices" in primitive:
        kind = asset.item("accessors", primitive["indices"])
        asset.claim(kind["type"] == "SCALAR" and kind["componentType"] in (5121, 5123, 5125), f"{name}: indices' type")
        indices = [row[0] for row in asset.values(primitive["indices"])]
        asset.claim(max(indices, default=0) < len(points), f"{name}: an index beyond the points")
        asset.claim(len(indices) % PRIMITIVE_OF[mode] == 0, f"{name}: indices do not make whole primitives")
    if "material" in primitive:
        check_material(asset, primitive["material"], attributes)


def check_material(asset, index, attributes):
    surface = asset.item("materials", index).get("pbrMetallicRoughness", {})
    color = surface.get("baseColorFactor", [1, 1, 1, 1])
    asset.claim(len(color) == 4 and all(0 <= c <= 1 for c in color), f"materials[{index}]: colour {color}")
    for key in ("metallicFactor", "roughnessFactor"):
        asset.claim(0 <= surface.get(key, 1) <= 1, f"materials[{index}]: {key}")
    if "baseColorTexture" in surface:
        texture = surface["baseColorTexture"]
        asset.claim(f"TEXCOORD_{texture.get('texCoord', 0)}" in attributes, f"materials[{index}]: no texture places")
        image = asset.item("images", asset.item("textures", texture["index"])["source"])
        asset.claim(image.get("mimeType") in ("image/png", "image/jpeg"), "an image without a type")
        view = asset.item("bufferViews", image["bufferView"])
        start = view.get("byteOffset", 0)
        check_png(asset, asset.buffers[view["buffer"]][start:start + view["byteLength"]])


def check_png(asset, data):
    if not asset.claim(data[:8] == b"\x89PNG\r\n\x1a\n", "the image is no PNG"):
        return
    at, kinds = 8, []
    while at + 12 <= len(data):
        (length,) = struct.unpack(">I", data[at:at + 4])
        chunk = data[at + 4:at + 8 + length]
        (crc,) = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        asset.claim(zlib.crc32(chunk) == crc, "a PNG chunk is damaged")
        kinds.append(chunk[:4])
        at += 12 + length
        if kinds[-1] == b"IEND":
            break
    asset.claim(kinds[:1] == [b"IHDR"] and kinds[-1:] == [b"IEND"], "the PNG is not whole")


def decomposable(m):
    """Whether a column-major matrix is translation, rotation and scale (3.5.3): its columns square to each other."""
    columns = [m[0:3], m[4:7], m[8:11]]
    sizes = [math.hypot(*c) for c in columns]
    square = all(abs(sum(a * b for a, b in zip(columns[i], columns[j]))) < 1e-6 * sizes[i] * sizes[j]
                 for i, j in ((0, 1), (1, 2), (0, 2)))
    return all(s > 0 for s in sizes) and square and m[3::4] == [0, 0, 0, 1]


def check_nodes(asset):
    parents = [0] * len(asset.gltf.get("nodes", []))
    for k, node in enumerate(asset.gltf.get("nodes", [])):
        for child in node.get("children", []):
            asset.item("nodes", child)
            parents[child] += 1
        for kind in ("mesh", "camera"):
            if kind in node:
                asset.item(kind + "es" if kind == "mesh" else kind + "s", node[kind])
        if "matrix" in node:
            asset.claim(decomposable(node["matrix"]), f"nodes[{k}]: a matrix that cannot be decomposed")
    asset.claim(all(n <= 1 for n in parents), "a node with two parents")
    for scene in asset.gltf.get("scenes", []):
        for root in scene.get("nodes", []):
            asset.item("nodes", root)
            asset.claim(parents[root] == 0, f"nodes[{root}] is a root and a child")
    for k, camera in enumerate(asset.gltf.get("cameras", [])):
        if camera["type"] == "perspective":
            p = camera["perspective"]
            good = p["yfov"] > 0 and p["znear"] > 0 and p.get("zfar", math.inf) > p["znear"]
            asset.claim(good and p.get("aspectRatio", 1) > 0, f"cameras[{k}]: {p}")


def problems(gltf):
    """What is wrong with a glTF of embedded buffers; empty: nothing that is looked at."""
    try:
        asset = Asset(gltf)
        asset.claim(gltf["asset"]["version"] == "2.0", "not version 2.0")
        check_buffers(asset)
        check_nodes(asset)
        for m, mesh in enumerate(gltf["meshes"]):
            asset.claim(len(mesh["primitives"]) > 0, f"meshes[{m}]: empty")
            for p, primitive in enumerate(mesh["primitives"]):
                check_primitive(asset, f"meshes[{m}].primitives[{p}]", primitive)
        for extension in gltf.get("extensionsRequired", []):
            asset.claim(extension in gltf.get("extensionsUsed", []), f"{extension} is not declared")
        return asset.problems
    except (KeyError, IndexError, ValueError, struct.error) as error:
        return [f"{type(error).__name__}: {error}"]
