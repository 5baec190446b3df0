"""Models that tests share."""

import pathlib

import mujoco
import pytest

MODELS = pathlib.Path(__file__).resolve().parents[2] / "models"

# A ball of radius 0.1 m on a vertical slide, one metre over the floor: free from q = -0.9 on.
BALL = """<mujoco model="ball"><worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="ball" pos="0 0 1"><joint name="up" type="slide" axis="0 0 1"/>
<geom name="sphere" size="0.1"/></body></worldbody></mujoco>"""

# The same, with a box on a mocap body in the place of the floor: its top is at the mocap's height.
OVER_MOCAP = """<mujoco><worldbody>
<body name="obstacle" mocap="true"><geom type="box" size="1 1 0.5" pos="0 0 -0.5"/></body>
<body name="ball" pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody></mujoco>"""


@pytest.fixture(scope="session")
def ball() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(BALL)


@pytest.fixture(scope="session")
def puma() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(MODELS / "puma" / "puma_car.xml"))


@pytest.fixture(scope="session")
def hand() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(MODELS / "hand" / "hand_bottle.xml"))
