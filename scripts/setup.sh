#!/usr/bin/env bash
# Makes .venv with the locked packages and this project in it, and sees to the system packages.
# Does only what is needed: a second run takes a second and downloads nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly VENV=.venv
readonly VENV_PYTHON=$VENV/bin/python

say() { printf '[setup] %s\n' "$*" >&2; }

is_supported() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null; }

find_python() {
    local candidate
    for candidate in ${PYTHON:-} python3.11 python3.12 python3; do
        if is_supported "$candidate"; then
            printf '%s' "$candidate"
            return
        fi
    done
    return 1
}

find_or_install_python() {
    if ! find_python; then
        say "no Python 3.11 or 3.12 found: asking the system for one"
        scripts/system_packages.sh python3 python3-venv
        find_python || {
            say "this system offers no Python 3.11 or 3.12."
            say "Install one and name it: make setup PYTHON=/path/to/python3.12"
            exit 1
        }
    fi
}

make_venv() {
    if [ -x $VENV_PYTHON ] && is_supported $VENV_PYTHON; then return; fi
    local python
    python=$(find_or_install_python)
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
        say "$python has no venv module: asking the system for it"
        scripts/system_packages.sh "$("$python" -c 'import sys; print("python3.%d-venv" % sys.version_info[1])')"
    fi
    say "making $VENV with $("$python" --version)"
    "$python" -m venv --clear $VENV
}

# The stamp $1 says that a step was done for the state $2.
is_done() { [ -f "$VENV/$1.stamp" ] && [ "$(cat "$VENV/$1.stamp")" = "$2" ]; }

mark_done() { printf '%s\n' "$2" >"$VENV/$1.stamp"; }

digest() { sha256sum | cut -d' ' -f1; }

pip() { $VENV_PYTHON -m pip --disable-pip-version-check --no-input "$@"; }

install_locked_packages() {
    local state
    state=$({ cat requirements.lock && $VENV_PYTHON --version; } | digest)
    if is_done lock "$state"; then return; fi
    say "installing the packages of requirements.lock (several GB; minutes the first time)"
    pip install --requirement requirements.lock
    mark_done lock "$state"
}

install_project() {
    local state
    state=$({ cat pyproject.toml && pwd; } | digest)
    if is_done project "$state"; then return; fi
    say "installing this project, editable"
    pip install --quiet --no-deps --no-build-isolation --editable .
    pip check
    mark_done project "$state"
}

main() {
    scripts/system_packages.sh
    make_venv
    install_locked_packages
    install_project
}

main </dev/null
