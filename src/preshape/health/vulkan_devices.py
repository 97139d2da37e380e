"""Lists the Vulkan devices of this machine as JSON.

Asks the Vulkan loader itself, because `vulkaninfo` is not on every machine. Run it as a process of its own: a
broken driver may take that down.
"""

import ctypes
import json
import sys

API_VERSION_1_2 = (1 << 22) | (2 << 12)
PROPERTIES_BYTES = 824  # VkPhysicalDeviceProperties, of which only the name is read
NAME_OFFSET, NAME_BYTES = 20, 256


class ApplicationInfo(ctypes.Structure):
    """VkApplicationInfo."""

    _fields_ = (
        ("type", ctypes.c_int32),
        ("next", ctypes.c_void_p),
        ("application_name", ctypes.c_char_p),
        ("application_version", ctypes.c_uint32),
        ("engine_name", ctypes.c_char_p),
        ("engine_version", ctypes.c_uint32),
        ("api_version", ctypes.c_uint32),
    )


class InstanceCreateInfo(ctypes.Structure):
    """VkInstanceCreateInfo; layers and extensions stay empty."""

    _fields_ = (
        ("type", ctypes.c_int32),
        ("next", ctypes.c_void_p),
        ("flags", ctypes.c_uint32),
        ("application_info", ctypes.POINTER(ApplicationInfo)),
        ("layers_and_extensions", ctypes.c_uint64 * 4),
    )


class DriverProperties(ctypes.Structure):
    """VkPhysicalDeviceDriverProperties."""

    _fields_ = (
        ("type", ctypes.c_int32),
        ("next", ctypes.c_void_p),
        ("driver_id", ctypes.c_int32),
        ("driver_name", ctypes.c_char * 256),
        ("driver_info", ctypes.c_char * 256),
        ("conformance_version", ctypes.c_uint8 * 4),
    )


class DeviceProperties(ctypes.Structure):
    """VkPhysicalDeviceProperties2."""

    _fields_ = (
        ("type", ctypes.c_int32),
        ("next", ctypes.c_void_p),
        ("properties", ctypes.c_uint8 * PROPERTIES_BYTES),
    )


def vulkan_devices() -> list[dict[str, str]]:
    """Name, driver and driver's version text of every Vulkan device.

    Raises:
        OSError: if there is no Vulkan loader.
    """
    vulkan = ctypes.CDLL("libvulkan.so.1")
    application = ApplicationInfo(type=0, api_version=API_VERSION_1_2)
    create = InstanceCreateInfo(type=1, application_info=ctypes.pointer(application))
    instance, count = ctypes.c_void_p(), ctypes.c_uint32()
    if vulkan.vkCreateInstance(ctypes.byref(create), None, ctypes.byref(instance)) != 0:
        return []
    vulkan.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), None)
    handles = (ctypes.c_void_p * count.value)()
    vulkan.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), handles)
    return [_describe(vulkan, ctypes.c_void_p(handle)) for handle in handles]


def _describe(vulkan: ctypes.CDLL, handle: ctypes.c_void_p) -> dict[str, str]:
    driver = DriverProperties(type=1000196000)
    device = DeviceProperties(type=1000059001, next=ctypes.cast(ctypes.pointer(driver), ctypes.c_void_p))
    vulkan.vkGetPhysicalDeviceProperties2(handle, ctypes.byref(device))
    name = bytes(device.properties)[NAME_OFFSET : NAME_OFFSET + NAME_BYTES].split(b"\0")[0]
    return {
        "name": name.decode(),
        "driver": driver.driver_name.decode(),
        "version": driver.driver_info.decode(),
    }


if __name__ == "__main__":
    try:
        json.dump(vulkan_devices(), sys.stdout)
    except OSError as error:
        sys.exit(str(error))
