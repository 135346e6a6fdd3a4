import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = os.environ["PYTHONPATH"].split(os.pathsep)[0]


def mypy(module, *words, **options):
    done = subprocess.run([sys.executable, "-m", module, *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, "MYPYPATH": PACKAGE}, **options)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stubs_say_what_is_there(tmp_path):
    allowed = tmp_path / "allowed"
    # Classes of pybind11 have a metaclass and a maker of their own, Settings has a mapping's methods, and some names
    # stand for types alone.
    allowed.write_text(r"""hotblade\._hotblade.*
hotblade\.(Cell|Check|Design|Plan|Program|Rib|Settings|Strip)([.]__init__)?
hotblade\.Settings\.get
hotblade\.curve\.(ArrayLike|NDArray|Numbers|NamedTuple)
hotblade\.batch\.(Design|Iterator|Program|Sequence|Settings)
hotblade\.calls\.(ArrayLike|Cell|Check|Design|Mapping|Plan|Program)
hotblade\.rpc\.Sequence
""")
    mypy("mypy.stubtest", "hotblade", "--allowlist", allowed, "--ignore-unused-allowlist", cwd=tmp_path)


def test_the_examples_keep_to_the_types(tmp_path):
    page = (SOURCE / "docs/python.md").read_text()
    lines = [match[1] for match in re.finditer(r"^(?:>>>|\.\.\.) (.*)$", page, re.M)]
    example = tmp_path / "example.py"
    example.write_text("\n".join(lines) + "\n")
    mypy("mypy", "--strict", "--cache-dir", tmp_path / "cache", example, cwd=tmp_path)
