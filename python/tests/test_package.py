import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["PYTHONPATH"].split(os.pathsep)[0]).parent


def wanted(major, minor):
    return f"python3 (>= {major}.{minor}), python3 (<< {major}.{minor + 1}), python3-numpy"


def test_the_package_asks_for_the_python_of_the_module():
    assert f'"{wanted(*sys.version_info[:2])}"' in (BUILD / "CPackConfig.cmake").read_text()


@pytest.mark.parametrize("minor", [9, 11, 13])
def test_any_minor_version_is_asked_for_by_its_number(minor, tmp_path):
    script = tmp_path / "say.cmake"
    script.write_text(f'include("{SOURCE}/cmake/HotbladePythonDepends.cmake")\nmessage("${{CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS}}")\n')
    done = subprocess.run(["cmake", "-DPython3_VERSION_MAJOR=3", f"-DPython3_VERSION_MINOR={minor}", "-P", script],
                          capture_output=True, text=True, check=True)
    assert done.stderr.strip() == wanted(3, minor)
