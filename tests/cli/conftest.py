"""The command line as a user calls it."""

import sys

import pytest

from railgate.cli import main


@pytest.fixture
def railgate(monkeypatch, capsys, tmp_path):
    """Run the command line: (exit code, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)  # what commands keep of their results is not the checkout's

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["railgate", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        out, err = capsys.readouterr()
        return ended.value.code, out, err

    return run
