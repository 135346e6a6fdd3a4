"""Designs that another maker's program wrote, read by hotblade: check_inputs.py CHECK HOTBLADE SAMPLES FOLDER
  formats    a sample as STL, PLY, glTF and GLB of assimp is the same surface
  plan       and gives the same plan
  convert    a documented conversion of another format gives the same surface
  refused    units, axes and names that contradict the file are refused, with their exit codes
Prints what differs, and exits with 1."""
import json
import pathlib
import shutil
import subprocess
import sys

check, hotblade, samples, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
folder = folder / check
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
failures = 0


def expect(holds, what):
    global failures
    if not holds:
        failures += 1
        print("FAILED:", what)


def run(*words):
    return subprocess.run([hotblade, *map(str, words)], capture_output=True, text=True)


def converted(source, name, code):
    """A file that assimp wrote, in the format of its code."""
    target = folder / name
    subprocess.run(["assimp", "export", source, target, f"-f{code}"], check=True, stdout=subprocess.DEVNULL)
    return target


def checked(file, *options):
    ended = run("check", file, *options, "--json")
    expect(ended.returncode == 0, f"check {file.name}: {ended.stderr}")
    return json.loads(ended.stdout)


def expect_same(file, met, wanted):
    for key in ("triangles", "vertices", "border_loops", "components", "orientable", "closed"):
        expect(met[key] == wanted[key], f"{file.name}: {key} {met[key]}, of the OBJ {wanted[key]}")
    # Other programs write single precision: seven digits of a coordinate.
    largest = max(abs(x) for corner in wanted["bbox_mm"] for x in corner)
    for corner, other in zip(met["bbox_mm"], wanted["bbox_mm"]):
        for a, b in zip(corner, other):
            expect(abs(a - b) <= 2e-7 * largest, f"{file.name}: bounding box {a}, of the OBJ {b}")
    expect(abs(met["area_mm2"] / wanted["area_mm2"] - 1) < 1e-6, f"{file.name}: area")


FORMATS = [("text.stl", "stl"), ("binary.stl", "stlb"), ("text.ply", "ply"), ("binary.ply", "plyb")]
SCENES = [("one.glb", "glb2"), ("beside.gltf", "gltf2")]

if check == "formats":
    for sample in ("hypar", "barrel_vault", "petal", "wave_wall"):
        obj = samples / f"{sample}.obj"
        wanted, as_scene = checked(obj, "--units", "mm"), checked(obj, "--units", "m", "--up", "y")
        for name, code in FORMATS:
            file = converted(obj, f"{sample}_{name}", code)
            expect_same(file, checked(file, "--units", "mm"), wanted)
        for name, code in SCENES:
            file = converted(obj, f"{sample}_{name}", code)
            expect_same(file, checked(file), as_scene)
elif check == "plan":
    obj = samples / "hypar.obj"

    def planned(file, *more):
        out = folder / (file.name + "_cut")
        ended = run("plan", file, "--units", "mm", "--config", samples / "hypar.toml", "-o", out, "--pictures", "none", *more)
        expect(ended.returncode == 0, f"plan {file.name}: {ended.stderr}")
        program = out / "program.json"
        expect(run("verify", program, "--design", file).returncode == 0, f"verify {file.name}")
        return json.loads(program.read_text())

    wanted = planned(obj)
    for name, code in FORMATS:
        met = planned(converted(obj, name, code))
        expect(len(met["strips"]) == len(wanted["strips"]), f"{name}: {len(met['strips'])} strips")
        for strip, other in zip(met["strips"], wanted["strips"]):
            expect(len(strip["poses"]) == len(other["poses"]), f"{name}: {len(strip['poses'])} poses")
            for pose, from_obj in zip(strip["poses"], other["poses"]):
                for clamp in ("a", "b"):
                    far = max(abs(x - y) for x, y in zip(pose[clamp]["p"], from_obj[clamp]["p"]))
                    expect(far < 1e-3, f"{name}: a clamp {far} mm off")
elif check == "convert":
    for sample in ("hypar", "petal"):
        obj = samples / f"{sample}.obj"
        dae = converted(obj, f"{sample}.dae", "collada")
        back = folder / f"{sample}_out.obj"
        subprocess.run(["assimp", "export", dae, back], check=True, stdout=subprocess.DEVNULL)
        expect_same(back, checked(back, "--units", "mm"), checked(obj, "--units", "mm"))
elif check == "refused":
    glb = converted(samples / "hypar.obj", "a.glb", "glb2")
    stl = converted(samples / "hypar.obj", "a.stl", "stlb")
    wrong = folder / "wrong.obj"
    shutil.copy(stl, wrong)
    cut = folder / "cut.stl"
    cut.write_bytes(stl.read_bytes()[:-1])
    for words, code, said in (((glb, "--units", "mm"), 2, "glTF is in metres"), ((glb, "--up", "z"), 2, "glTF has y up"),
                              ((glb, "--set", "design.units=in"), 2, "glTF is in metres"),
                              ((stl,), 2, "no unit given"), ((stl, "--units", "mm", "--format", "3ds"), 2, "--format"),
                              ((wrong, "--units", "mm"), 3, "the name says obj, the bytes say stl"),
                              ((wrong, "--units", "mm", "--format", "stl"), 0, ""),
                              ((cut, "--units", "mm"), 3, "cut.stl: byte 80: "),
                              ((glb, "--units", "m"), 0, ""), ((glb, "--up", "y"), 0, ""), ((glb,), 0, "")):
        ended = run("check", *words)
        expect(ended.returncode == code and said in ended.stderr,
               f"check {' '.join(map(str, words))}: exit {ended.returncode}: {ended.stderr}")
sys.exit(failures > 0)
