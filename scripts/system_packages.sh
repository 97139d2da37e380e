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

apt_install() {
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes -qq --no-install-recommends -o Dpkg::Use-Pty=0 "$@" >&2
}

apt_update() { as_root apt-get update -qq || say "some lists of packages could not be read; going on with the others"; }

# The entry for Debian 12's backports, on the mirror that this system already uses.
backports_source() {
    local mirror
    mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Codename: bookworm' 'Created-By: Packages' | sed -n 1p)
    printf '%s\n' 'Types: deb' "URIs: ${mirror:?no apt source for bookworm is configured}" \
        'Suites: bookworm-backports' 'Components: main' \
        'Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg'
}

install_mesa() {
    local candidate
    candidate=$(apt-cache policy $MESA | sed -n 's/^ *Candidate: //p')
    if recent_enough "${candidate/(none)/}"; then
        apt_install $MESA
    elif [ "$(codename)" = bookworm ]; then
        if ! apt-cache madison $MESA | grep -q bookworm-backports; then
            say "adding bookworm-backports in $BACKPORTS_SOURCE"
            backports_source | as_root tee "$BACKPORTS_SOURCE" >/dev/null
            apt_update
        fi
        apt_install --target-release bookworm-backports $MESA
    else
        say "rendering needs $MESA $MESA_NEEDED or newer; this system offers $candidate."
        say "Install a newer one, or the Vulkan driver of your graphics card, and run the same command again."
        exit 1
    fi
}

print_commands() {
    say "missing: $*"
    say "type this, then run the same command again:"
    local from=""
    if [ "$(codename)" = bookworm ] && mesa_needed; then
        printf "    sudo tee %s >/dev/null <<'END'\n%s\nEND\n" "$BACKPORTS_SOURCE" "$(backports_source)" >&2
        from="--target-release bookworm-backports "
    fi
    printf '    sudo apt-get update\n    sudo apt-get install %s%s\n' "$from" "$*" >&2
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
    if [ ${#missing[@]} = 0 ] && ! mesa_needed; then return; fi

    if ! can_be_root; then
        if mesa_needed; then missing+=("$MESA"); fi
        print_commands "${missing[@]}"
        exit 1
    fi
    say "reading the lists of packages"
    apt_update
    if [ ${#missing[@]} -gt 0 ]; then
        say "installing ${missing[*]}"
        apt_install "${missing[@]}"
    fi
    if mesa_needed; then
        say "installing Mesa's Vulkan drivers"
        install_mesa
    fi
}

main "$@" </dev/null
