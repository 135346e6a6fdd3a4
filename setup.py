"""pip install --no-build-isolation . : the module and what it links, built by CMake (docs/python.md)."""
from skbuild import setup

setup(
    name="hotblade",
    version="0.2.0",
    description="Plan hot-blade cutting of architectural formwork",
    packages=["hotblade"],
    package_dir={"": "python"},
    package_data={"hotblade": ["*.pyi", "py.typed"]},
    python_requires=">=3.11",
    install_requires=["numpy>=1.21,<2"],
    cmake_args=["-GNinja", "-DCMAKE_BUILD_TYPE=Release", "-DHOTBLADE_BUILD_PYTHON=ON", "-DHOTBLADE_BUILD_TESTS=OFF"],
    cmake_install_target="hotblade_python_install",
    include_package_data=False,
)
