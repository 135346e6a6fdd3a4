import doctest
import pathlib

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def test_every_example_of_the_page_is_true(samples, monkeypatch):
    monkeypatch.chdir(samples)
    done = doctest.testfile(str(SOURCE / "docs/python.md"), module_relative=False)
    assert done.attempted > 20 and done.failed == 0
