"""The scene against the glTF 2.0 specification."""
import copy
import json

from gltf_rules import problems
from program_curves import expect, main


def scene(directory):
    return json.loads((directory / "scene.gltf").read_text())


def gltf(directory):
    for path in (directory / "scene.gltf", directory / "job" / "scene.gltf"):
        found = problems(json.loads(path.read_text()))
        expect(not found, f"{path.name}: {found[:5]}")


def broken(directory):
    whole = scene(directory)
    textured = next(p for m in whole["meshes"] for p in m["primitives"] if "TEXCOORD_0" in p["attributes"])
    position = textured["attributes"]["POSITION"]
    breakages = {
        "version": lambda g: g["asset"].update(version="1.0"),
        "minimum": lambda g: g["accessors"][position]["min"].__setitem__(0, -1e6),
        "no maximum": lambda g: g["accessors"][position].pop("max"),
        "count": lambda g: g["accessors"][position].update(count=10 ** 7),
        "alignment": lambda g: g["accessors"][position].update(byteOffset=2),
        "view": lambda g: g["bufferViews"][0].update(byteLength=10 ** 9),
        "missing view": lambda g: g["accessors"][0].update(bufferView=999),
        "colour": lambda g: g["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[2, 0, 0, 1]),
        "texture places": lambda g: g["meshes"][whole["meshes"].index(next(
            m for m in whole["meshes"] if textured in m["primitives"]))]["primitives"][0]["attributes"].pop("TEXCOORD_0"),
        "image": lambda g: g["images"][0].update(bufferView=0),
        "skewed node": lambda g: g["nodes"][0]["matrix"].__setitem__(4, 0.001),
        "two parents": lambda g: g["nodes"][0].update(children=[1]),
        "mode": lambda g: g["meshes"][0]["primitives"][0].update(mode=7),
    }
    for name, breakage in breakages.items():
        damaged = copy.deepcopy(whole)
        breakage(damaged)
        expect(problems(damaged), f"{name}: a broken scene passes")


main({"gltf": gltf, "broken": broken})
