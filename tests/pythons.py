"""The Pythons of this machine that can run the game; as a command, prints all but this one."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

__all__ = ["pythons"]


def pythons() -> dict[str, str]:
    """Return an executable by version, such as ``3.12``, from 3.11 on; this Python for its own."""
    folders = [os.environ.get("PATH", os.defpath)]
    if pyenv := shutil.which("pyenv"):
        told = subprocess.run(
            [pyenv, "root"], capture_output=True, text=True, timeout=60, check=True
        )
        # First, because pyenv's commands on the path work for the selected versions only.
        folders = [*map(str, Path(told.stdout.strip()).glob("versions/*/bin")), *folders]
    path = os.pathsep.join(folders)
    found = {f"3.{minor}": shutil.which(f"python3.{minor}", path=path) for minor in range(11, 21)}
    found[f"3.{sys.version_info.minor}"] = sys.executable
    return {version: python for version, python in found.items() if python}


if __name__ == "__main__":
    others = (python for python in pythons().values() if python != sys.executable)
    sys.stdout.writelines(f"{python}\n" for python in others)
