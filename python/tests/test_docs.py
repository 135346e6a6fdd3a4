import doctest
import pathlib
import shutil

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PAGE = SOURCE / "docs/python.md"


def test_every_example_of_the_page_is_true(samples, program, tmp_path, monkeypatch):
    for file in (*samples.glob("*.obj"), *samples.glob("*.toml")):
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    commands = [line.split() for line in PAGE.read_text().splitlines() if line.startswith("    hotblade ")]
    for words in commands:
        program(*words[1:], "-q")
    assert len(commands) == 2
    done = doctest.testfile(str(PAGE), module_relative=False)
    assert done.attempted > 20 and done.failed == 0
