"""Makes the rigid scenes *.xml and assets/*.obj; the bunny and the dragon, with their scene, go to the folder that is
given, since they are too big to keep: make_rigid.py [FOLDER_OF_BIG_ONES]"""
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
sys.path.insert(0, str(HERE))

import shapes
from mesh_tools import write_obj
from scene_tools import element, joint_qpos

COMMENT = """
{about} Made by make_rigid.py; change that, not this.

Units: m, kg, s. The first body is free, the second stands; both are marked as exact meshes, since their convex hulls
say nothing here. Inertia is that of the closed meshes. {free}: {free_count} triangles, {fixed}: {fixed_count}.
Keyframe home is free, the others penetrate. {answer}
"""

# scene: what it is; free mesh, standing mesh; keyframes (x, y, z, rotation vector in degrees); known answer
SCENES = {
    "spoon_cup": ("A spoon in a cup, after Tang & Kim's benchmark.", "spoon", "cup", {
        "home": (0, 0, 0.20), "stuck_in_wall": (0, 0.02, 0.09, -60, 0, 0), "across_rim": (0.01, 0.04, 0.10)}, ""),
    "pawn_cad": ("A chess piece and a CAD part (a gear), after Tang & Kim's benchmark.", "pawn", "cad", {
        "home": (0, 0, 0.06), "in_web": (0.05, 0, -0.02), "in_bore": (0.004, 0, -0.05, 10, 0, 0)}, ""),
    "hammer_bumpy_sphere": ("A hammer and a bumpy sphere, after Tang & Kim's benchmark.", "hammer", "bumpy_sphere", {
        "home": (0, 0, 0.12), "head_touches": (0.132, 0, -0.245), "handle_through": (0.02, 0.01, -0.15, 20, 10, 0)}, ""),
    "l_shape_torus_knot": ("An L and a torus knot, after Tang & Kim's benchmark.", "l_shape", "torus_knot", {
        "home": (0.25, 0, 0), "arm_in_knot": (0.06, 0, -0.03), "in_the_middle": (-0.05, -0.05, -0.03, 30, 20, 0)}, ""),
    "spoon_box": ("A spoon and a box: the quantitative test of Tang & Kim's Fig. 11.", "spoon", "block", {
        "home": (0, 0, 0.08), "bowl_dips": (0, 0, 0.055), "tilted": (0, 0, 0.05, 0, 15, 0), "inside": (0.02, 0, 0.03)},
        "For the spoon Izz is ten times Iyy: translations across y\nand the turn about y are all that counts."),
    "ring_on_post": ("A ring around a post.", "ring", "post", {
        "home": (0, 0, 0.06), "off_centre": (0.035, 0, 0.06), "tilted": (0.015, 0, 0.06, 0, 60, 0)},
        "off_centre: the hole's radius is 40 mm, the post's 20 mm, so 15 mm back is the answer, sigma = 2.25e-4 m^2\n"
        "(the polygons make it up to 0.3 mm more)."),
    "linked_rings": ("Two links of a chain.", "ring", "link", {
        "home": (0, 0, 0), "pulled_apart": (-0.04, 0, 0), "pushed_together": (0.045, 0, 0, 10, 0, 0)}, ""),
    "nut_on_bolt": ("A nut on a bolt with a helical thread (pitch 8 mm, play 0.6 mm).", "nut", "bolt", {
        "home": (0, 0, 0.016), "quarter_turn": (0, 0, 0.016, 0, 0, 90), "lifted": (0, 0, 0.019)},
        "quarter_turn: not advanced by the 2 mm that a quarter of a turn takes."),
    "ball_in_cup": ("A ball in a cup.", "ball", "cup", {
        "home": (0, 0, 0.06), "through_wall": (0.02, 0, 0.06), "through_bottom": (0, 0, 0.025)},
        "through_bottom: the inner bottom lies at 8 mm and the radius is 30 mm: at least 13 mm up."),
}
BIG_SCENES = {
    "bunny_dragon": ("An animal with long ears and a dragon, after Tang & Kim's Bunny/Dragon.", "bunny", "dragon", {
        "home": (0, 0, 0.30), "on_its_back": (0.02, 0, 0.11), "in_its_body": (-0.02, 0.01, 0.04, 20, 0, 30)}, ""),
}


def link():
    """The ring turned upright and moved, so that the other one goes through it."""
    ring = shapes.ring()
    return ring._replace(vertices=[(x + 0.05, -z, y) for x, y, z in ring.vertices])


MESHES = {"spoon": shapes.spoon, "cup": shapes.cup, "pawn": shapes.pawn, "cad": shapes.gear, "hammer": shapes.hammer,
          "bumpy_sphere": shapes.bumpy_sphere, "l_shape": shapes.l_shape, "torus_knot": shapes.torus_knot,
          "block": lambda: shapes.box(0.12, 0.12, 0.05), "ring": shapes.ring, "post": shapes.post, "link": link,
          "nut": shapes.nut, "bolt": shapes.bolt, "ball": shapes.ball, "bunny": shapes.bunny, "dragon": shapes.dragon}


def write_scene(folder, name, meshes, scene):
    about, free, fixed, keys, answer = scene
    root = ET.Element("mujoco", model=name)
    element(root, "compiler", meshdir="assets")
    element(root, "visual")
    element(root[-1], "headlight", ambient=(0.35, 0.35, 0.35), diffuse=(0.5, 0.5, 0.5), specular=(0.1, 0.1, 0.1))
    element(element(root, "custom"), "text", name="mjcf_pdg.exact_mesh", data=f"{free} {fixed}")
    asset, world, keyframe = (element(root, tag) for tag in ("asset", "worldbody", "keyframe"))
    for mesh, rgba in ((free, (0.85, 0.35, 0.25, 1)), (fixed, (0.6, 0.65, 0.7, 1))):
        element(asset, "mesh", name=mesh, file=f"{mesh}.obj", inertia="exact")
        body = element(world, "body", name=mesh)
        if mesh == free:
            joint = element(body, "freejoint", name=mesh)
        element(body, "geom", name=mesh, type="mesh", mesh=mesh, rgba=rgba)
    for key, pose in keys.items():
        element(keyframe, "key", name=key, qpos=joint_qpos(joint, (*pose, 0, 0, 0)[:6]))
    ET.indent(root)
    comment = COMMENT.format(about=about, free=free, free_count=len(meshes[free].faces), fixed=fixed,
                             fixed_count=len(meshes[fixed].faces), answer=answer).strip()
    (folder / f"{name}.xml").write_text(f"<!--\n{comment}\n-->\n{ET.tostring(root, encoding='unicode')}\n")


def write_scenes(folder, scenes):
    names = sorted({mesh for scene in scenes.values() for mesh in scene[1:3]})
    meshes = {name: MESHES[name]() for name in names}
    assets = folder / "assets"
    assets.mkdir(parents=True, exist_ok=True)
    for name, mesh in meshes.items():
        write_obj(assets / f"{name}.obj", mesh)
    for name, scene in scenes.items():
        write_scene(folder, name, meshes, scene)


def main():
    if len(sys.argv) > 1:
        write_scenes(Path(sys.argv[1]), BIG_SCENES)
    else:
        write_scenes(HERE, SCENES)


if __name__ == "__main__":
    main()
