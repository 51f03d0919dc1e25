#!/usr/bin/env bash
# Installs what grades submissions, for the interpreter PYTHON, or else for one of its own.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
if [ -z "${PYTHON:-}" ]; then
  apt-get update
  for version in 3.13 3.12 3.11; do
    if apt-get install -y "python$version-venv"; then break; fi
  done
  root="${AUTOGRADER:-/autograder}"
  "python$version" -m venv "$root/venv"
  PYTHON="$root/venv/bin/python"
fi
# A wheel beside this script is as good as a release.
"$PYTHON" -m pip install --find-links "$here" "logical-robots-tui==VERSION" "pyyaml>=6"
