"""Designs that another maker's program wrote, read by hotblade: check_inputs.py CHECK HOTBLADE SAMPLES FOLDER
  formats    every sample as STL, PLY, glTF and GLB of assimp, and as STL and PLY of VTK, is the same surface
  plan       and gives the same plan
  convert    a documented conversion of another format gives the same surface
  meshio     the documented line for meshio turns VTK files into the surface they were written of; exit code 77 without meshio
  vtk        and that of VTK its polygons, the design of `preview --export` among them
  step       the documented line for gmsh turns a STEP file into its surface, in mm; exit code 77 without gmsh
  refused    units, axes and names that contradict the file are refused, with their exit codes
Prints what differs, and exits with 1."""
import json
import math
import pathlib
import re
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


def dxf_faces(obj):
    """An OBJ's faces as DXF, which has each with its own corners."""
    lines = [words.split() for words in obj.read_text().splitlines()]
    points = [words[1:4] for words in lines if words[:1] == ["v"]]
    text = ["0", "SECTION", "2", "ENTITIES"]
    for words in lines:
        if words[:1] != ["f"]:
            continue
        corners = [points[int(w.split("/")[0]) - 1] for w in words[1:]]
        text += ["0", "3DFACE", "8", "0"]
        for i in range(4):
            for axis, at in enumerate(corners[min(i, len(corners) - 1)]):
                text += [str(10 * (axis + 1) + i), at]
    return "\n".join([*text, "0", "ENDSEC", "0", "EOF", ""])


def run(*words):
    return subprocess.run([hotblade, *map(str, words)], capture_output=True, text=True)


def converted(source, name, code):
    """A file that assimp wrote, in the format of its code."""
    target = folder / name
    subprocess.run(["assimp", "export", source, target, f"-f{code}"], check=True, stdout=subprocess.DEVNULL)
    return target


def polygons_of(obj):
    """What VTK reads of an OBJ."""
    import vtk
    reader = vtk.vtkOBJReader()
    reader.SetFileName(str(obj))
    reader.Update()
    return reader.GetOutput()


def grid_of(file):
    """What VTK reads of a grid of its own format."""
    import vtk
    reader = vtk.vtkUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def written(writer, data, target, **how):
    """A file that a writer of VTK made, binary unless said."""
    import vtk
    made = getattr(vtk, writer)()
    made.SetFileName(str(target))
    if hasattr(made, "SetFileType"):
        made.SetFileType(how.get("type", BINARY))
    if "order" in how:
        made.SetDataByteOrder(how["order"])
    made.SetInputData(data)
    expect(made.Write() == 1, f"VTK writes {target.name}")
    return target


def written_by_vtk(source, name, writer, **how):
    """A file that a writer of VTK made of an OBJ."""
    return written(writer, polygons_of(source), folder / name, **how)


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
ASCII, BINARY, LITTLE, BIG = 1, 2, 0, 1
VTK_FORMATS = [("vtk_text.stl", "vtkSTLWriter", {"type": ASCII}), ("vtk_binary.stl", "vtkSTLWriter", {"type": BINARY}),
               ("vtk_text.ply", "vtkPLYWriter", {"type": ASCII}),
               ("vtk_little.ply", "vtkPLYWriter", {"type": BINARY, "order": LITTLE}),
               ("vtk_big.ply", "vtkPLYWriter", {"type": BINARY, "order": BIG})]
SCENES = [("one.glb", "glb2"), ("beside.gltf", "gltf2")]

if check == "formats":
    for obj in sorted(samples.glob("*.obj")):
        sample = obj.stem
        wanted, as_scene = checked(obj, "--units", "mm"), checked(obj, "--units", "m", "--up", "y")
        for name, code in FORMATS:
            file = converted(obj, f"{sample}_{name}", code)
            expect_same(file, checked(file, "--units", "mm"), wanted)
        for name, writer, how in VTK_FORMATS:
            file = written_by_vtk(obj, f"{sample}_{name}", writer, **how)
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
    files = [converted(obj, name, code) for name, code in FORMATS]
    files += [written_by_vtk(obj, name, writer, **how) for name, writer, how in VTK_FORMATS]
    for file in files:
        name, met = file.name, planned(file)
        expect(met["design"]["format"] == file.suffix[1:], f"{name}: {met['design']}")
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
        dxf = folder / f"{sample}.dxf"
        dxf.write_text(dxf_faces(obj))
        back = folder / f"{sample}_dxf.obj"
        subprocess.run(["assimp", "export", dxf, back], check=True, stdout=subprocess.DEVNULL)
        expect_same(back, checked(back, "--units", "mm", "--up", "y"), checked(obj, "--units", "mm"))
elif check == "meshio":
    if shutil.which("meshio") is None:
        print("meshio is not installed")
        sys.exit(77)
    page = (pathlib.Path(__file__).resolve().parents[2] / "docs/inputs.md").read_text()
    line = re.search(r"`(meshio convert in[.]vtk [^`]*)`", page)[1].split()
    for sample in ("hypar", "petal"):
        lines = [words.split() for words in (samples / f"{sample}.obj").read_text().splitlines()]
        points = [words[1:4] for words in lines if words[:1] == ["v"]]
        faces = [[int(w.split("/")[0]) - 1 for w in words[1:]] for words in lines if words[:1] == ["f"]]
        kinds = {3: 5, 4: 9}  # VTK's numbers for a triangle and a quadrilateral
        work = folder / f"{sample}_vtk"
        work.mkdir(exist_ok=True)
        (work / "in.vtk").write_text("\n".join(
            ["# vtk DataFile Version 3.0", sample, "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double",
             *(" ".join(p) for p in points), f"CELLS {len(faces)} {sum(1 + len(f) for f in faces)}",
             *(" ".join(map(str, [len(f), *f])) for f in faces), f"CELL_TYPES {len(faces)}",
             *(str(kinds[len(f)]) for f in faces), ""]))
        wanted = checked(samples / f"{sample}.obj", "--units", "mm")
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL, cwd=work)
        expect_same(work / "out.obj", checked(work / "out.obj", "--units", "mm"), wanted)
        # The same grid as VTK itself writes it, binary and as XML.
        grid = grid_of(work / "in.vtk")
        for name, writer in (("in.vtk", "vtkUnstructuredGridWriter"), ("in.vtu", "vtkXMLUnstructuredGridWriter")):
            written(writer, grid, work / name)
            words = [name if word == "in.vtk" else word for word in line]
            (work / "out.obj").unlink()
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL, cwd=work)
            expect_same(work / "out.obj", checked(work / "out.obj", "--units", "mm"), wanted)
elif check == "vtk":
    page = (pathlib.Path(__file__).resolve().parents[2] / "docs/inputs.md").read_text()
    line = re.search(r"`(python3 -c \"import vtk[^`]*)`", page)[1]
    for sample in ("hypar", "petal"):
        wanted = checked(samples / f"{sample}.obj", "--units", "mm")
        work = folder / sample
        work.mkdir()
        for name, writer in (("in.vtk", "vtkPolyDataWriter"), ("in.vtp", "vtkXMLPolyDataWriter")):
            written(writer, polygons_of(samples / f"{sample}.obj"), work / name)
            refused = run("check", work / name, "--units", "mm")
            said = re.search(r"`(.*)`", refused.stderr)[1]
            expect(refused.returncode == 3, f"check {name}: exit {refused.returncode}")
            as_page = line if name == "in.vtp" else line.replace("vtkXMLPolyDataReader", "vtkPolyDataReader").replace("in.vtp", name)
            expect(said == as_page, f"check {name} says {said}, the page {as_page}")
            subprocess.run(said.replace("python3", sys.executable), check=True, cwd=work, shell=True)
            expect_same(work / "out.ply", checked(work / "out.ply", "--units", "mm"), wanted)
            (work / "out.ply").unlink()
    # What hotblade itself exports for ParaView is the design that was planned.
    design, cut = samples / "hypar.obj", folder / "cut"
    ended = run("plan", design, "--units", "mm", "--config", samples / "hypar.toml", "-o", cut, "--pictures", "none")
    expect(ended.returncode == 0, f"plan: {ended.stderr}")
    ended = run("preview", cut / "program.json", "--design", design, "--export", folder / "scene.vtm")
    expect(ended.returncode == 0, f"preview --export: {ended.stderr}")
    first = re.search(r'<DataSet index="0" name="design" file="([^"]*)"', (folder / "scene.vtm").read_text())[1]
    shutil.copy(folder / first, folder / "in.vtp")
    subprocess.run(line.replace("python3", sys.executable), check=True, cwd=folder, shell=True)
    expect_same(folder / "out.ply", checked(folder / "out.ply", "--units", "mm"), checked(design, "--units", "mm"))
elif check == "step":
    if shutil.which("gmsh") is None:
        print("gmsh is not installed")
        sys.exit(77)
    here = pathlib.Path(__file__).resolve().parent
    page = (here.parents[1] / "docs/inputs.md").read_text()
    line = re.search(r"`(gmsh in[.]step [^`]*)`", page)[1].split()
    model = (here / "quarter_cylinder.step").read_text()
    # A quarter of a cylinder of radius 400 and length 300, and the same numbers as metres.
    for unit, scale in (("SI_UNIT(.MILLI.,.METRE.)", 1), ("SI_UNIT($,.METRE.)", 1000)):
        work = folder / str(scale)
        work.mkdir()
        (work / "in.step").write_text(model.replace("SI_UNIT(.MILLI.,.METRE.)", unit))
        words = [str(20 * scale) if w == "20" else w for w in line]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL, cwd=work)
        met = checked(work / "out.stl", "--units", "mm")
        expect(met["closed"] and met["components"] == 1 and not met["repairs"][1:], f"gmsh: {met['repairs']}")
        size = [b - a for a, b in zip(*met["bbox_mm"])]
        expect(all(abs(a - b * scale) < 1e-6 * scale for a, b in zip(size, (300, 400, 400))), f"gmsh: size {size}")
        numbers = [float(w) for w in re.findall(r"vertex\s+(\S+)\s+(\S+)\s+(\S+)", (work / "out.stl").read_text())
                   for w in w]
        far = 0
        for k in range(0, len(numbers), 9):
            corners = [numbers[k + i:k + i + 3] for i in (0, 3, 6)]
            if any(abs(math.hypot(c[1], c[2]) - 400 * scale) > 1e-6 * scale for c in corners):
                continue  # of an end or of a side
            around = [math.atan2(c[2], -c[1]) for c in corners]
            far = max(far, 400 * scale * (1 - math.cos((max(around) - min(around)) / 2)))
        print(f"gmsh: {far} mm off a radius of {400 * scale} mm")
        expect(0 < far <= 10 / 200**2 * 400 * scale, f"gmsh: {far} mm off the cylinder")
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
