"""Writes one MJCF scene: elements, mesh files, keyframes given joint by joint. Standard library only."""
import math
import xml.etree.ElementTree as ET

from mesh_tools import write_obj


def text(value):
    """An attribute as MJCF text: strings as they are, numbers with nine digits, sequences with blanks."""
    if isinstance(value, str):
        return value
    if isinstance(value, (int, float)):
        return "%.9g" % (round(value, 9) + 0.0)
    return " ".join(text(v) for v in value)


def element(parent, tag, **attributes):
    return ET.SubElement(parent, tag, {k.rstrip("_"): text(v) for k, v in attributes.items()})


def radians(*degrees):
    return tuple(math.radians(d) for d in degrees)


def quaternion(rotation):
    """Of a rotation vector in degrees."""
    angle = math.sqrt(sum(r * r for r in rotation))
    if angle == 0:
        return (1.0, 0.0, 0.0, 0.0)
    half = math.radians(angle) / 2
    return (math.cos(half),) + tuple(math.sin(half) * r / angle for r in rotation)


def joint_qpos(joint, value=None):
    """Slide in m, hinge in degrees, ball: rotation vector in degrees, free: (x, y, z, rotation vector)."""
    if joint.tag == "freejoint":
        x, y, z, *rotation = value or (0, 0, 0)
        return [x, y, z, *quaternion(rotation)]
    kind = joint.get("type", "hinge")
    if kind == "ball":
        return quaternion(value or ())
    return [math.radians(value or 0) if kind == "hinge" else value or 0]


class Scene:
    """`world` is the worldbody; bodies must be added depth first, which is the order of MuJoCo's qpos.

    With `assets_of`, another generator's folder, the mesh files are those that are there already.
    """

    def __init__(self, name, folder, assets_of=None):
        self.folder, self.name, self.assets_of = folder, name, assets_of
        self.meshes, self.triangles = {}, {}  # by mesh name; by geom name
        self.root = ET.Element("mujoco", model=name)
        element(self.root, "compiler", angle="radian", autolimits="true", meshdir=f"../{assets_of}/assets" if assets_of else "assets")
        element(self.root, "option", timestep=0.002, integrator="implicitfast")
        visual = element(self.root, "visual")
        element(visual, "global", offwidth=1920, offheight=1080)
        element(visual, "headlight", ambient=(0.35, 0.35, 0.35), diffuse=(0.45, 0.45, 0.45), specular=(0.1, 0.1, 0.1))
        element(visual, "quality", shadowsize=4096)
        self.asset = element(self.root, "asset")
        self.world = element(self.root, "worldbody")
        self.actuator = element(self.root, "actuator")
        self.keyframe = element(self.root, "keyframe")

    def stage(self, camera_pos, camera_xyaxes, look_at, extent, tile):
        """Sky, sun, camera "view" and the floor z = 0 with tiles of that size; extent is the scene's half size."""
        sky = {"rgb1": (0.75, 0.84, 0.93), "rgb2": (0.97, 0.97, 0.98)}
        element(self.asset, "texture", name="sky", type="skybox", builtin="gradient", width=256, height=1536, **sky)
        element(self.asset, "texture", name="tiles", type="2d", builtin="checker", width=256, height=256,
                rgb1=(0.78, 0.79, 0.80), rgb2=(0.72, 0.73, 0.75))
        element(self.asset, "material", name="floor", texture="tiles", texuniform="true",
                texrepeat=(0.5 / tile, 0.5 / tile))
        self.look(camera_pos, camera_xyaxes, look_at, extent)
        element(self.world, "geom", name="floor", type="plane", size=(6 * extent, 6 * extent, 0.1), material="floor")

    def look(self, camera_pos, camera_xyaxes, look_at, extent):
        """Sun and camera alone."""
        element(self.root, "statistic", center=look_at, extent=extent)
        sun = (-0.9 * extent, -1.3 * extent, 4 * extent)
        element(self.world, "light", name="sun", type="spot", pos=sun, dir=[c - s for c, s in zip(look_at, sun)],
                cutoff=60, exponent=1, diffuse=(0.6, 0.6, 0.57), specular=(0.25, 0.25, 0.25), castshadow="true")
        element(self.world, "camera", name="view", pos=camera_pos, xyaxes=camera_xyaxes, fovy=42)

    def material(self, name, rgba, specular=0.4, shininess=0.5):
        element(self.asset, "material", name=name, rgba=rgba, specular=specular, shininess=shininess)

    def mesh_geom(self, body, name, mesh, **attributes):
        """Adds a mesh geom of the same name; an equal mesh that was written before is used again."""
        known = next((other for other in self.meshes if self.meshes[other] == mesh), None)
        if known is None:
            self.meshes[name] = mesh
            element(self.asset, "mesh", name=name, file=f"{name}.obj")
        self.triangles[name] = len(mesh.faces)
        element(body, "geom", name=name, type="mesh", mesh=known or name, **attributes)

    def supersphere(self, body, name, half_axes, roundness, resolution, **attributes):
        """Adds a geom of one of MuJoCo's own meshes, for which there is no file; roundness 1 is an ellipsoid, 0 a box."""
        element(self.asset, "mesh", name=name, builtin="supersphere", params=(resolution, roundness, roundness),
                scale=half_axes)
        self.triangles[name] = 2 * resolution * (resolution - 1)
        element(body, "geom", name=name, type="mesh", mesh=name, **attributes)

    def count(self, body):
        """Links and mesh triangles of a body and all below it."""
        links = sum(1 for _ in body.iter("body"))
        return links, sum(self.triangles.get(geom.get("name"), 0) for geom in body.iter("geom"))

    def qpos(self, name, pose):
        """Of a pose called `name`: joint name -> its part of qpos; see key."""
        joints = {j.get("name"): j for j in self.world.iter() if j.tag in ("joint", "freejoint")}
        unknown = sorted(set(pose) - set(joints))
        if unknown:
            raise KeyError(f"{name}: no joint {unknown}")
        return {joint: joint_qpos(joints[joint], pose.get(joint)) for joint in joints}

    def key(self, name, pose):
        """A keyframe from joint name -> value (see joint_qpos); what is not named stays at zero."""
        values = self.qpos(f"keyframe {name}", pose)
        targets = [values[drive.get("joint")] for drive in self.actuator]
        element(self.keyframe, "key", name=name, qpos=values.values(), **({"ctrl": targets} if targets else {}))

    def write(self, comment):
        if self.meshes and not self.assets_of:
            assets = self.folder / "assets"
            assets.mkdir(exist_ok=True)
            for old in assets.glob("*.obj"):
                old.unlink()
            for name, mesh in self.meshes.items():
                write_obj(assets / f"{name}.obj", mesh)
        if not len(self.actuator):
            self.root.remove(self.actuator)
        ET.indent(self.root)
        body = ET.tostring(self.root, encoding="unicode")
        (self.folder / f"{self.name}.xml").write_text(f"<!--\n{comment.strip()}\n-->\n{body}\n")
