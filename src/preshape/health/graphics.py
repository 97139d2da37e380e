"""Vulkan, the simulator's renderer and Open3D's libraries."""

import json
import re
from pathlib import Path

from preshape.health.finding import Finding, ProbeResult, Status, probe

MESA_NEEDED = (24, 3)
PACKAGE_OF_LIBRARY = {
    "libusb-1.0.so": "libusb-1.0-0",
    "libGL.so": "libgl1",
    "libEGL.so": "libegl1",
    "libgomp.so": "libgomp1",
    "libX11.so": "libx11-6",
}
INSTALL = "scripts/system_packages.sh (installs it, or says what to type)"


def check_vulkan() -> Finding:
    """Whether there is a Vulkan device that SAPIEN can render with."""
    return judge_vulkan(probe(str(Path(__file__).with_name("vulkan_devices.py"))))


def judge_vulkan(listing: ProbeResult) -> Finding:
    """The finding for a list of Vulkan devices as printed by `vulkan_devices`."""
    if not listing.succeeded:
        return Finding("Vulkan device", Status.FAIL, listing.text, INSTALL)
    devices = json.loads(listing.text)
    if not devices:
        return Finding("Vulkan device", Status.FAIL, "the loader finds no device", INSTALL)
    detail = ", ".join(f"{device['name']} with {device['version']}" for device in devices)
    if all(_is_old_mesa(device["version"]) for device in devices):
        needed = ".".join(map(str, MESA_NEEDED))
        return Finding("Vulkan device", Status.FAIL, f"{detail}; Mesa {needed} or newer is needed", INSTALL)
    return Finding("Vulkan device", Status.OK, detail)


def check_simulator() -> Finding:
    """Whether SAPIEN loads and finds a device to render with."""
    result = probe("-c", "import sapien; sapien.render.RenderSystem(); print(sapien.__version__)")
    if result.succeeded:
        return Finding("Simulator", Status.OK, f"SAPIEN {result.text} renders")
    return Finding("Simulator", Status.FAIL, result.text, f"make setup, and {INSTALL}")


def check_open3d() -> Finding:
    """Whether Open3D loads with its system libraries."""
    return judge_open3d(probe("-c", "import open3d; print(open3d.__version__)"))


def judge_open3d(result: ProbeResult) -> Finding:
    """The finding for the way in which importing Open3D ended."""
    if result.succeeded:
        return Finding("Open3D", Status.OK, result.text)
    for library, package in PACKAGE_OF_LIBRARY.items():
        if library in result.text:
            return Finding("Open3D", Status.FAIL, result.text, f"sudo apt-get install {package}")
    return Finding("Open3D", Status.FAIL, result.text, f"make setup, and {INSTALL}")


def _is_old_mesa(driver_version: str) -> bool:
    mesa = re.match(r"Mesa (\d+)\.(\d+)", driver_version)
    return mesa is not None and tuple(map(int, mesa.groups())) < MESA_NEEDED
