#!/usr/bin/env bash
# Makes sure that the system packages are there: the libraries of Open3D and SAPIEN, and a Vulkan driver.
# As root or with a password-less sudo it installs what is missing; otherwise it says what to type.
# Further packages may be named as arguments.
set -euo pipefail

readonly LIBRARIES=(libusb-1.0-0 libgl1 libegl1 libgomp1 libx11-6 libvulkan1)
readonly MESA=mesa-vulkan-drivers
readonly MESA_NEEDED=24.3 # the software renderer of older ones lacks descriptor indexing, which SAPIEN needs
readonly BACKPORTS_SOURCE=/etc/apt/sources.list.d/preshape-backports.sources

say() { printf '[system packages] %s\n' "$*" >&2; }

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi; }

can_be_root() { [ "$(id -u)" = 0 ] || sudo -n true 2>/dev/null; }

codename() { (. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}"); }

installed_version() {
    dpkg-query --show --showformat='${db:Status-Status} ${Version}' "$1" 2>/dev/null | sed -n 's/^installed //p'
}

recent_enough() { [ -n "$1" ] && dpkg --compare-versions "$1" ge "$MESA_NEEDED"; }

# An NVIDIA card whose driver brings its own Vulkan needs no Mesa.
nvidia_renders() {
    compgen -G '/dev/nvidia[0-9]*' >/dev/null || return 1
    compgen -G '/usr/share/vulkan/icd.d/nvidia_icd*' >/dev/null || compgen -G '/etc/vulkan/icd.d/nvidia_icd*' >/dev/null
}

mesa_needed() { ! nvidia_renders && ! recent_enough "$(installed_version $MESA)"; }

apt_update() {
    say "reading the lists of packages"
    as_root apt-get update -qq || say "some lists of packages could not be read; going on with the others"
}

# The entry for Debian 12's backports, on the mirror that this system already uses.
backports_source() {
    local mirror
    mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Codename: bookworm' 'Created-By: Packages' | sed -n 1p)
    printf '%s\n' 'Types: deb' "URIs: ${mirror:?no apt source for bookworm is configured}" \
        'Suites: bookworm-backports' 'Components: main' \
        'Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg'
}

backports_offered() { [[ "$(apt-cache madison $MESA)" == *bookworm-backports* ]]; }

add_backports() {
    say "adding bookworm-backports in $BACKPORTS_SOURCE"
    backports_source | as_root tee "$BACKPORTS_SOURCE" >/dev/null
    apt_update
}

# Installs packages; Mesa's must all come from one release, so backports are preferred for all where they are used.
install() {
    local from=()
    apt_update
    if [[ " $* " == *" $MESA "* ]] && [ "$(codename)" = bookworm ] && ! backports_offered; then add_backports; fi
    if backports_offered; then from=(--target-release bookworm-backports); fi
    say "installing $*"
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes -qq --no-install-recommends -o Dpkg::Use-Pty=0 "${from[@]}" "$@" >&2
    if mesa_needed; then
        say "rendering needs $MESA $MESA_NEEDED or newer; this system offers $(installed_version $MESA)."
        say "Install a newer one, or the Vulkan driver of your graphics card, and run the same command again."
        exit 1
    fi
}

print_commands() {
    say "missing: $*"
    say "type this, then run the same command again:"
    local release=""
    if [ "$(codename)" = bookworm ]; then
        release="--target-release bookworm-backports "
        printf "    sudo tee %s >/dev/null <<'END'\n%s\nEND\n" "$BACKPORTS_SOURCE" "$(backports_source)" >&2
    fi
    printf '    sudo apt-get update\n    sudo apt-get install %s%s\n' "$release" "$*" >&2
}

main() {
    if ! command -v apt-get >/dev/null; then
        say "this is neither Debian nor Ubuntu: please see to ${LIBRARIES[*]} and a Vulkan driver yourself"
        return
    fi
    local missing=() package
    for package in "${LIBRARIES[@]}" "$@"; do
        [ -n "$(installed_version "$package")" ] || missing+=("$package")
    done
    if mesa_needed; then missing+=("$MESA"); fi
    if [ ${#missing[@]} = 0 ]; then return; fi
    if ! can_be_root; then
        print_commands "${missing[@]}"
        exit 1
    fi
    install "${missing[@]}"
}

main "$@" </dev/null
