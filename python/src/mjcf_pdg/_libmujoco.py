"""Lets the extension use the libmujoco that the user's `mujoco` package has loaded."""

import ctypes
import os
import pathlib

import mujoco

# Any patch number of it: the models and data of 4.0.0 and 4.0.1 have the same layout.
VERSION = "4.0"


def share() -> None:
    """Makes the functions of the one libmujoco of this process known to the extension.

    The extension does not name the library that it needs, because its file name has the full version
    in it. Raises ImportError for another MuJoCo than the extension was built for.
    """
    version = mujoco.mj_versionString()
    if not version.startswith(VERSION + "."):
        raise ImportError(f"mjcf_pdg was built for MuJoCo {VERSION}.x, but the package mujoco is {version}")
    library = pathlib.Path(mujoco._structs.__file__).with_name(f"libmujoco.so.{version}")
    try:  # RTLD_NOLOAD: the one that is in the process already, never a second one
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL | os.RTLD_NOLOAD)
    except OSError as error:
        raise ImportError(f"the package mujoco {version} does not use {library}") from error
