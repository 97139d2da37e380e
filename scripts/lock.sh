#!/usr/bin/env bash
# Writes requirements.lock: the exact versions in .venv, without build tags such as +cpu, which hold for one index only.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

versions=$(.venv/bin/python -m pip freeze --all --exclude pip --exclude-editable | sed 's/+.*//')
if grep -n '@' <<<"$versions"; then
    echo "These packages come from files, not from an index: install them by version first." >&2
    exit 1
fi
{
    printf '# Exact versions of the tested environment, for Python 3.11 and 3.12. Written by `make lock`; do not edit.\n'
    printf '%s\n' "$versions"
} >requirements.lock.new
mv requirements.lock.new requirements.lock
