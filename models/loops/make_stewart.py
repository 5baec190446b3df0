"""Writes stewart.xml: a platform on six legs, each of a universal joint and a slide, whose ends are pinned to it."""

import math
import pathlib

BASE, TOP, HEIGHT = 0.25, 0.15, 0.35  # radii of the anchors, and the platform's height at qpos0 [m]


def anchor(radius, k, half_gap):
    """The k-th of six anchors on a circle, in pairs that are 2 * half_gap apart [rad]."""
    angle = 2 * math.pi / 3 * (k // 2) + (half_gap if k % 2 else -half_gap)
    return radius * math.cos(angle), radius * math.sin(angle)


def leg(k):
    x0, y0 = anchor(BASE, k, 0.25)
    x1, y1 = anchor(TOP, k, math.pi / 3 - 0.25)
    dx, dy, dz = x1 - x0, y1 - y0, HEIGHT
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    pinned = f"0 0 {length:.9f}"
    body = f"""    <body name="lower{k}" pos="{x0:.9f} {y0:.9f} 0" zaxis="{dx:.9f} {dy:.9f} {dz:.9f}">
      <joint name="tilt{k}" axis="1 0 0"/><joint name="swing{k}" axis="0 1 0"/>
      <geom name="lower{k}" type="capsule" size=".014" fromto="0 0 .03 0 0 {0.5 * length:.9f}"/>
      <body name="upper{k}">
        <joint name="leg{k}" type="slide" axis="0 0 1" range="-.1 .12"/>
        <geom name="upper{k}" type="capsule" size=".008" fromto="0 0 {0.45 * length:.9f} 0 0 {length - 0.02:.9f}"/>
      </body>
    </body>
"""
    pin = f"""    <connect name="pin{k}" body1="upper{k}" body2="platform" anchor="{pinned}"/>
"""
    exclude = f"""    <exclude body1="platform" body2="upper{k}"/>
"""
    return body, pin, exclude


bodies, pins, excludes = zip(*(leg(k) for k in range(6)))
text = f"""<!-- Written by make_stewart.py: a platform on six legs that slide, each pinned to it, under a shelf. -->
<mujoco model="stewart">
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" pos="0 0 -.05"/>
    <geom name="shelf" type="box" size=".1 .3 .02" pos=".22 0 .43"/>
    <body name="platform" pos="0 0 {HEIGHT}">
      <freejoint name="platform"/>
      <geom name="platform" type="cylinder" size=".17 .012" mass="2"/>
      <geom name="load" type="box" size=".05 .05 .04" pos="0 0 .052" mass="1"/>
    </body>
{"".join(bodies)}  </worldbody>
  <contact>
{"".join(excludes)}  </contact>
  <equality>
{"".join(pins)}  </equality>
</mujoco>
"""
(pathlib.Path(__file__).parent / "stewart.xml").write_text(text)
